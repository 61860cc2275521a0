#pragma once
// Guarantees of every model reader.

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "fuzz/input.h"
#include "scene/model.h"

namespace binosplat::fuzz {

inline bool finite(std::span<const float> values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

template <typename Vector>
std::span<const float> floats(const std::vector<Vector>& values) {
  return {&values[0].x, values.size() * static_cast<std::size_t>(Vector::length())};
}

/// The guarantees of scene/model.h.
inline void check(const Model& model) {
  const std::size_t n = model.count();
  demand(n > 0, "a model without Gaussians");
  demand(model.degree >= 0 && model.degree <= 3, "a degree beyond 3");
  demand(model.scale.size() == n && model.rotation.size() == n && model.opacity.size() == n &&
             model.sh.size() == n * 3 * static_cast<std::size_t>(sh_count(model.degree)),
         "arrays of different lengths");
  demand(finite(floats(model.position)) && finite(floats(model.scale)) && finite(model.sh),
         "values that are not finite");
  for (std::size_t i = 0; i < n; ++i) {
    demand(std::abs(glm::length(model.rotation[i]) - 1.0f) < 1e-5f, "a rotation not of unit length");
    demand(model.opacity[i] >= 0.0f && model.opacity[i] <= 1.0f, "an opacity beyond 0 to 1");
    demand(glm::all(glm::greaterThanEqual(model.scale[i], glm::vec3(0.0f))), "a negative scale");
  }
}

}  // namespace binosplat::fuzz
