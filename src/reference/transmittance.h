#pragma once
// Measures each Gaussian's visibility in a view, which Th may use in the next frame (docs/method.md 5).

#include <vector>

#include "reference/project.h"
#include "reference/tiles.h"

namespace binosplat::reference {

/// Value of a Gaussian in no tile's list: outside the view, or dropped by Th.
constexpr double not_seen = -1.0;

/// For each Gaussian, max(T): the largest T in front of it over the pixels that blend it. 0 if no pixel
/// blends it, because all ended earlier or its alpha is below tau; not_seen if no tile lists it. The result
/// does not depend on the number of threads.
std::vector<double> measure_transmittance(const std::vector<Splat>& splats, const TileLists& lists,
                                          const shared::View& view);

/// For each Gaussian, the blending weight alpha * T, summed over the pixels that blend it.
std::vector<double> measure_weights(const std::vector<Splat>& splats, const TileLists& lists,
                                    const shared::View& view);

/// For each Gaussian, alpha T^2, summed over the pixels that blend it at a T of at least VISIBILITY_LEAST:
/// the visibility of its errors.
std::vector<double> measure_visibility(const std::vector<Splat>& splats, const TileLists& lists,
                                       const shared::View& view);

/// Converts a measurement for set_thresholds(): at least `floor`, and 1 for Gaussians that were not seen.
std::vector<double> floored(std::vector<double> measured, double floor);

}  // namespace binosplat::reference
