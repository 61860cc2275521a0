#pragma once
// Scaffold-GS models as their trainer leaves them: point_cloud.ply with the anchors, and beside it the
// networks opacity_mlp.pt, cov_mlp.pt, color_mlp.pt and, where they were trained, embedding_appearance.pt and
// feature_bank_mlp.pt.
//
// Anchors: binary_little_endian float32; x y z, f_offset_* (3 K, component-major: f_offset_(c * K + k)),
// f_anchor_feat_* (F), scale_0..5 (logarithms: 3 of offsets, 3 of Gaussians), rot_0..3. K and F are the
// numbers of these properties; what else a network takes in (the distance, an appearance) follows from the
// sizes of its weights. Of inputs F + 3 + 1 or F + 3 + A + 1 the one is the distance; where an appearance's
// size could be read both ways, it is A.

#include <filesystem>
#include <memory>
#include <vector>

#include "formats/ply_header.h"
#include "scene/scaffold.h"

namespace binosplat {

/// Whether a ply file holds anchors of Scaffold-GS: property f_anchor_feat_0.
bool is_scaffold(const PlyHeader& header);

/// Reads anchors and networks. Anchors with values that are not finite are left out and counted. Throws
/// Error naming the file, and what was expected: a network missing or of other sizes than K and F ask for, a
/// ply cut short or of other types, no anchors.
std::shared_ptr<Scaffold> load_scaffold(const std::filesystem::path& ply);

/// The networks that belong beside such a ply file, also those that not every model has.
std::vector<std::filesystem::path> files_of_networks(const std::filesystem::path& ply);

}  // namespace binosplat
