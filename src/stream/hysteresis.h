#pragma once
// What choices of levels have in common (stream/choice.h).

#include <algorithm>
#include <cstddef>
#include <glm/glm.hpp>
#include <span>

#include "stream/choice.h"

namespace binosplat {

/// Chunks that are worth a thread's while.
inline constexpr std::size_t chunks_at_once = 256;

/// By how much a level must be too coarse, or finer than need be, before it is left: heads are never still.
inline constexpr double inertia = 1.1;

/// By what the need of a level is multiplied: by 1.1 if it is not finer than the chunk's level before, else
/// by 1 / 1.1; by 1 where there was none.
inline double inertia_of(std::span<const std::size_t> before, std::size_t chunk, std::size_t level) {
  if (before.empty()) return 1.0;
  return level < before[chunk] ? 1.0 / inertia : inertia;
}

/// From an eye to the box, at least a hundredth of its diagonal: 0 within it would hide how coarse its
/// Gaussians are.
inline double distance_to(const LodChunk& chunk, const glm::dvec3& eye) {
  return std::max(glm::distance(eye, glm::clamp(eye, chunk.low, chunk.high)),
                  0.01 * glm::distance(chunk.low, chunk.high));
}

}  // namespace binosplat
