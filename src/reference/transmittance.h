#pragma once
// How much of each Gaussian a view shows: what Th may use in the next frame (docs/method.md 5).

#include <vector>

#include "reference/project.h"
#include "reference/tiles.h"

namespace binosplat::reference {

/// What is said of a Gaussian in no tile's list: outside the view or left out by Th.
constexpr double not_seen = -1.0;

/// For each Gaussian the largest T in front of it over the pixels that blend it, max(T). 0 where no pixel
/// blends it, because each had ended before it or because its alpha is below tau in all; not_seen where no
/// tile has it. The same bits with any number of threads.
std::vector<double> measure_transmittance(const std::vector<Splat>& splats, const TileLists& lists,
                                          const shared::View& view);

/// For each Gaussian its blending weight alpha * T, summed over the pixels that blend it; 0 where none does.
std::vector<double> measure_weights(const std::vector<Splat>& splats, const TileLists& lists,
                                    const shared::View& view);

/// For each Gaussian alpha T^2, likewise, while T is VISIBILITY_LEAST at least: how much an error of it would
/// be seen.
std::vector<double> measure_seen(const std::vector<Splat>& splats, const TileLists& lists,
                                 const shared::View& view);

/// A measurement as set_thresholds() takes it: at least `floor`, and 1 where the Gaussian was not seen.
std::vector<double> floored(std::vector<double> measured, double floor);

}  // namespace binosplat::reference
