#pragma once
// Measures each Gaussian in a view: max(T), which Th may use in the next frame (docs/method.md 5), weight,
// and visibility.

#include <vector>

#include "reference/project.h"
#include "reference/tiles.h"

namespace binosplat::reference {

/// The max(T) of a Gaussian that is in no tile's list: it is outside the view, or Th dropped it.
constexpr double not_seen = -1.0;

/// Returns max(T) of each Gaussian: the largest T in front of it over the pixels that blend it; not_seen if
/// no tile lists the Gaussian; 0 if all pixels ended before or alpha is below tau. Independent of threads.
std::vector<double> measure_transmittance(const std::vector<Splat>& splats, const TileLists& lists,
                                          const shared::View& view);

/// Returns the blending weight of each Gaussian: alpha T, summed over the pixels that blend it.
std::vector<double> measure_weights(const std::vector<Splat>& splats, const TileLists& lists,
                                    const shared::View& view);

/// Returns the visibility of each Gaussian: alpha T^2, summed over the pixels that blend it with a T of at
/// least VISIBILITY_MIN. It is the weight of the Gaussian's error.
std::vector<double> measure_visibility(const std::vector<Splat>& splats, const TileLists& lists,
                                       const shared::View& view);

/// Converts max(T) to the bounds of set_thresholds(): at least `floor`, and 1 for not_seen.
std::vector<double> floored(std::vector<double> measured, double floor);

}  // namespace binosplat::reference
