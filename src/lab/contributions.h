#pragma once
// What single Gaussians contribute to a view by distance from their middles, the transmittance in front of
// them by depth, and what a picture loses without the lowest contributions (AdaGScale, figures 4 to 6). In
// float64 on the CPU: how the frame draws plays no part in it.

#include <span>
#include <vector>

#include "lab/bench_case.h"
#include "lab/results.h"
#include "scene/model.h"

namespace binosplat::lab {

/// Rows "of" three kinds, over the first eyes of all views:
/// skipping: what pictures keep without the lowest contributions, "by" what is known of the transmittance;
/// means over the views;
/// distance: alpha T of fragments, by their distance from the Gaussian's middle in px;
/// depth: max(T) of the Gaussians that a pixel blends, by their view depth in world units.
/// T_upper(depth) is the `table`'s for skipping, and the `fitted` one's for the bins of depth.
std::vector<Row> contributions(const Model& model, std::span<const BenchView> views, const DepthTable& table,
                               const DepthTable& fitted);

}  // namespace binosplat::lab
