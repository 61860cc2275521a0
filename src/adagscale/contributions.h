#pragma once
// Measures single Gaussians as in AdaGScale's figures 4 to 6: contributions by distance from the middle,
// transmittance by depth, and the loss without the lowest contributions. All numbers are computed in float64
// on the CPU, so frame settings do not affect them.

#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "adagscale/calibrate.h"
#include "scene/model.h"

namespace binosplat::adagscale {

using Row = nlohmann::ordered_json;

/// Returns rows of three kinds, named in their column "kind":
/// - skipping: the PSNR without the lowest contributions, mean over the views. "formula" has that of the
///   contributions, in which T_upper(depth) comes from `table`.
/// - distance: alpha T of fragments, by their distance from the Gaussian's middle in px.
/// - depth: max(T) of blended Gaussians by view depth in world units, and T_upper from `fitted`.
std::vector<Row> contributions(const Model& model, std::span<const CalibrationView> views, double near_plane,
                               const DepthTable& table, const DepthTable& fitted);

}  // namespace binosplat::adagscale
