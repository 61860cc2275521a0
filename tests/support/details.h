#pragma once
// What tests of levels of detail ask of chunks.

#include <vector>

#include "stream/choice.h"

namespace binosplat::test {

/// How many Gaussians the chunks have at the levels that were chosen; chunks without levels have none.
inline std::size_t gaussians_of(const std::vector<LodChunk>& chunks, const std::vector<std::size_t>& chosen) {
  std::size_t sum = 0;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    if (!chunks[i].levels.empty()) sum += chunks[i].levels[chosen[i]].count;
  }
  return sum;
}

/// A view at a place; where it looks does not matter.
inline shared::View view_at(const glm::dvec3& eye, float focal = 100.0f) {
  shared::View view{};
  view.anchor = glm::vec4(eye, 0.2f);
  view.lens = {focal, focal, 0, 0};
  return view;
}

/// Places beside the first and the last part of the fixture sog/st-lod, and one far from all.
inline const glm::dvec3 beside_first = {-14, -1, 0}, beside_last = {6, 0, 15}, far_away = {0, 0, -400};

}  // namespace binosplat::test
