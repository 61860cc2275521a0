#pragma once
// Parts of demo:city.

#include "base/random.h"
#include "demo/common_parts.h"

namespace binosplat::demo {

template <std::size_t n>
dvec3 pick(Random& random, const dvec3 (&colours)[n]) {
  return colours[static_cast<std::size_t>(random.uniform() * n)];
}

/// Adds random houses, wall to wall, with fronts from `start` to the right as seen from the street.
void add_row(SceneBuilder& stage, Random& random, const dvec3& start, const dvec3& to_right, double length);

}  // namespace binosplat::demo
