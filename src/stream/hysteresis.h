#pragma once
// Helpers of both ways to choose levels (stream/choice.h).

#include <algorithm>
#include <cstddef>
#include <glm/glm.hpp>
#include <span>

#include "stream/choice.h"

namespace binosplat {

/// Chunks that a thread processes at a time.
inline constexpr std::size_t chunks_at_once = 256;

/// The factor by which a chunk's error or spacing must miss the request before its level changes, since heads
/// are never still.
inline constexpr double inertia = 1.1;

/// Returns the factor on the need for a level: 1.1 if it is no finer than the chunk's previous level,
/// otherwise 1 / 1.1. It is 1 without a previous choice.
inline double inertia_of(std::span<const std::size_t> before, std::size_t chunk, std::size_t level) {
  if (before.empty()) return 1.0;
  return level < before[chunk] ? 1.0 / inertia : inertia;
}

/// Returns the distance from an eye to the chunk's box, at least a hundredth of the box's diagonal: 0 within
/// the box would hide the spacing of its Gaussians.
inline double distance_to(const LodChunk& chunk, const glm::dvec3& eye) {
  return std::max(glm::distance(eye, glm::clamp(eye, chunk.low, chunk.high)),
                  0.01 * glm::distance(chunk.low, chunk.high));
}

}  // namespace binosplat
