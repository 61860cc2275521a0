#pragma once
// Chunks and views for tests of levels of detail.

#include <vector>

#include "stream/level_choice.h"

namespace binosplat::test {

/// Returns the number of Gaussians of the chunks at the chosen levels. Chunks without levels count as empty.
inline std::size_t gaussians_of(const std::vector<LodChunk>& chunks, const std::vector<std::size_t>& chosen) {
  std::size_t sum = 0;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    if (!chunks[i].levels.empty()) sum += chunks[i].levels[chosen[i]].count;
  }
  return sum;
}

/// Returns a view at a position; its direction does not matter.
inline shared::View view_at(const glm::dvec3& eye, float focal = 100.0f) {
  shared::View view{};
  view.anchor = glm::vec4(eye, 0.2f);
  view.lens = {focal, focal, 0, 0};
  return view;
}

/// Positions near the first and the last chunk of the fixture sog/st-lod, and one far from all.
inline const glm::dvec3 beside_first = {-14, -1, 0}, beside_last = {6, 0, 15}, far_away = {0, 0, -400};

}  // namespace binosplat::test
