#pragma once
// What smooth ways through given places have in common.

#include <algorithm>
#include <glm/glm.hpp>

namespace binosplat {

/// Catmull-Rom's slope at a knot from the slopes of the chords into it and out of it, which take the times
/// `before` and `after`. Where one of them is much slower than the other (a turn on the spot, a walk straight
/// ahead) it is bounded so that no way overshoots.
template <typename V>
V slope_between(const V& in, const V& out, double before, double after) {
  const V slope = (after * in + before * out) / (before + after);
  const double steepest = 3.0 * std::min(glm::length(in), glm::length(out));
  const double steep = glm::length(slope);
  return steep > steepest ? slope * (steepest / steep) : slope;
}

}  // namespace binosplat
