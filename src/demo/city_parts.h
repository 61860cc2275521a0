#pragma once
// demo:city inside.

#include "base/random.h"
#include "demo/scenery.h"

namespace binosplat::demo {

/// One of a list of colours.
template <std::size_t n>
dvec3 pick(Random& random, const dvec3 (&colours)[n]) {
  return colours[static_cast<std::size_t>(random.uniform() * n)];
}

/// Houses by lot, wall to wall, whose fronts begin at `start` and lead to the right as one stands before
/// them. They are as detailed as the stage's grain allows there.
void add_row(Stage& stage, Random& random, const dvec3& start, const dvec3& to_right, double length);

}  // namespace binosplat::demo
