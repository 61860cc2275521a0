#pragma once
// What all choices of levels go by (stream/detail.h).

#include <algorithm>
#include <cstddef>
#include <glm/glm.hpp>
#include <span>

#include "stream/detail.h"

namespace binosplat {

/// Parts that are worth a thread's while.
inline constexpr std::size_t chunk_of_parts = 256;

/// By how much a level must be too coarse, or finer than need be, before it is left: heads are never still.
inline constexpr double inertia = 1.1;

/// By how much more a level is needed that is not finer than the one before, and by how much less one that
/// is.
inline double inertia_of(std::span<const std::size_t> before, std::size_t part, std::size_t level) {
  if (before.empty()) return 1.0;
  return level < before[part] ? 1.0 / inertia : inertia;
}

/// From an eye to the box, at least a hundredth of its diagonal: 0 within it would hide how coarse its
/// Gaussians are.
inline double distance_to(const DetailPart& part, const glm::dvec3& eye) {
  return std::max(glm::distance(eye, glm::clamp(eye, part.low, part.high)),
                  0.01 * glm::distance(part.low, part.high));
}

}  // namespace binosplat
