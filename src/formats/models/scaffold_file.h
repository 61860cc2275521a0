#pragma once
// Scaffold-GS models as their trainer writes them: point_cloud.ply with the anchors, and the networks
// opacity_mlp.pt, cov_mlp.pt, color_mlp.pt and, if trained, embedding_appearance.pt and feature_bank_mlp.pt.
//
// Anchors: binary_little_endian float32; x y z, f_offset_* (3 K, component-major: f_offset_(c * K + k)),
// f_anchor_feat_* (F), scale_0..5 (logarithms: 3 of offsets, 3 of Gaussians), rot_0..3. The numbers of these
// properties give K and F. A network has F + 3 inputs (features and direction), optionally A for an
// appearance, and optionally one for the distance. The sizes of its weights give the number of inputs. If the
// inputs beyond F + 3 fit an appearance both with and without a distance, all of them are the appearance.

#include <filesystem>
#include <memory>
#include <vector>

#include "formats/containers/opened_file.h"
#include "scene/scaffold.h"

namespace binosplat {

/// Returns whether a ply file contains anchors of Scaffold-GS: property f_anchor_feat_0.
bool is_scaffold(const PlyHeader& header);

/// Reads the anchors, K and F of a ply file. Throws Error naming the file.
void load_anchors(const OpenedFile& ply, Scaffold& scaffold);

/// Reads anchors and networks. Drops anchors with values that are not finite and counts them. Throws Error if
/// a network is missing or does not fit K and F, or if the ply is cut short, has other types or no anchors.
/// The text names the file and the expected value.
std::shared_ptr<Scaffold> load_scaffold(const OpenedFile& file);

std::vector<std::filesystem::path> files_of_networks(const std::filesystem::path& ply);

}  // namespace binosplat
