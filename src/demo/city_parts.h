#pragma once
// Parts of demo:city.

#include "base/random.h"
#include "demo/scenery.h"

namespace binosplat::demo {

/// Returns a random one of a list of colours.
template <std::size_t n>
dvec3 pick(Random& random, const dvec3 (&colours)[n]) {
  return colours[static_cast<std::size_t>(random.uniform() * n)];
}

/// Adds random houses, wall to wall. Their fronts begin at `start` and run to the right as seen from the
/// street. Their detail follows the stage's grain there.
void add_row(Stage& stage, Random& random, const dvec3& start, const dvec3& to_right, double length);

}  // namespace binosplat::demo
