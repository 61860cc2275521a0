#pragma once
// What choices of levels have in common (stream/choice.h).

#include <algorithm>
#include <cstddef>
#include <glm/glm.hpp>
#include <span>

#include "stream/choice.h"

namespace binosplat {

/// The chunks that a thread handles at a time.
inline constexpr std::size_t chunks_at_once = 256;

/// The factor by which a chunk's error or spacing must miss what is asked for before its level changes: heads
/// are never still.
inline constexpr double inertia = 1.1;

/// The factor of the need of a level: 1.1 if it is not finer than the chunk's level before, else 1 / 1.1; 1
/// where there was no choice before.
inline double inertia_of(std::span<const std::size_t> before, std::size_t chunk, std::size_t level) {
  if (before.empty()) return 1.0;
  return level < before[chunk] ? 1.0 / inertia : inertia;
}

/// The distance from an eye to the chunk's box, at least a hundredth of the box's diagonal: 0 within the box
/// would hide how coarse its Gaussians are.
inline double distance_to(const LodChunk& chunk, const glm::dvec3& eye) {
  return std::max(glm::distance(eye, glm::clamp(eye, chunk.low, chunk.high)),
                  0.01 * glm::distance(chunk.low, chunk.high));
}

}  // namespace binosplat
