#pragma once
// Measures single Gaussians as AdaGScale's figures 4 to 6 do: contributions to a view by distance from their
// middles, transmittance in front of them by depth, and the loss without the lowest contributions. In float64
// on the CPU, so independent of the frame's settings.

#include <span>
#include <vector>

#include "lab/bench_case.h"
#include "lab/results.h"
#include "scene/model.h"

namespace binosplat::lab {

/// Rows of three kinds, by their key "of", over the first eyes of all views:
/// skipping: quality without the lowest contributions. "by" names the transmittance used; means over the
/// views.
/// distance: alpha T of fragments, by their distance from the Gaussian's middle in px.
/// depth: max(T) of blended Gaussians, by view depth in world units.
/// T_upper(depth) comes from `table` for skipping, and from `fitted` for the bins of depth.
std::vector<Row> contributions(const Model& model, std::span<const BenchView> views, const DepthTable& table,
                               const DepthTable& fitted);

}  // namespace binosplat::lab
