#pragma once
// Helpers of choose_by_spacing() and choose_by_error() (stream/level_choice.h).

#include <algorithm>
#include <cstddef>
#include <glm/glm.hpp>
#include <span>

#include "stream/level_choice.h"

namespace binosplat {

/// Chunks that a thread processes at a time.
inline constexpr std::size_t chunks_at_once = 256;

/// A chunk's level changes only if its error or spacing misses the request by this factor. Otherwise levels
/// would change all the time, since heads are never still.
inline constexpr double inertia = 1.1;

/// Returns the factor on a chunk's error or spacing when a step to `level` is considered: 1 / 1.1 if the
/// level is finer than the chunk's level `before`, otherwise 1.1. Without a previous choice the factor is 1.
inline double inertia_of(std::span<const std::size_t> before, std::size_t chunk, std::size_t level) {
  if (before.empty()) return 1.0;
  return level < before[chunk] ? 1.0 / inertia : inertia;
}

/// Returns an eye's distance from the chunk's box, at least 1/100 of the box's diagonal: it is a divisor.
inline double distance_to(const LodChunk& chunk, const glm::dvec3& eye) {
  return std::max(glm::distance(eye, glm::clamp(eye, chunk.low, chunk.high)),
                  0.01 * glm::distance(chunk.low, chunk.high));
}

}  // namespace binosplat
