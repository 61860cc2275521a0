#pragma once
// Scaffold-GS models as their trainer writes them: point_cloud.ply with the anchors, and beside it the
// networks opacity_mlp.pt, cov_mlp.pt, color_mlp.pt and, if trained, embedding_appearance.pt and
// feature_bank_mlp.pt.
//
// Anchors: binary_little_endian float32; x y z, f_offset_* (3 K, component-major: f_offset_(c * K + k)),
// f_anchor_feat_* (F), scale_0..5 (logarithms: 3 of offsets, 3 of Gaussians), rot_0..3. The numbers of these
// properties give K and F. The sizes of a network's weights give its further inputs. With F + 3 + 1 or F + 3
// + A + 1 inputs, the last one is the distance, and A is the size of an appearance. If both readings fit an
// appearance's size, all further inputs are the appearance.

#include <filesystem>
#include <memory>
#include <vector>

#include "formats/ply_header.h"
#include "scene/scaffold.h"

namespace binosplat {

/// Returns whether a ply file contains anchors of Scaffold-GS: property f_anchor_feat_0.
bool is_scaffold(const PlyHeader& header);

/// Reads anchors and networks. Drops anchors with values that are not finite and counts them. Throws Error
/// naming the file and the expected value: a network missing or of sizes that do not fit K and F, a ply cut
/// short or of other types, no anchors.
std::shared_ptr<Scaffold> load_scaffold(const std::filesystem::path& ply);

/// Returns the files of networks beside such a ply file, including the optional ones.
std::vector<std::filesystem::path> files_of_networks(const std::filesystem::path& ply);

}  // namespace binosplat
