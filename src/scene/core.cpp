#include "scene/core.h"

#include <algorithm>
#include <vector>

#include "base/error.h"

namespace binosplat {

Core core_of(const Model& model) {
  if (model.count() == 0) fail("{}: the model has no Gaussians", model.name);
  Core core;
  std::vector<double> values(model.count());
  // Takes the upper of two middle values, so that the ball around one of two Gaussians reaches the other.
  const auto median = [&](const auto& value) {
    std::transform(model.position.begin(), model.position.end(), values.begin(), value);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  for (int i = 0; i < 3; ++i)
    core.middle[i] = median([i](const glm::vec3& p) { return static_cast<double>(p[i]); });
  core.radius = median([&](const glm::vec3& p) { return glm::length(glm::dvec3(p) - core.middle); });
  if (core.radius == 0.0) {  // half of the Gaussians lie at one point: use a Gaussian's size
    const glm::vec3& s = model.scale[0];
    core.radius =
        std::max({static_cast<double>(s.x), static_cast<double>(s.y), static_cast<double>(s.z), 1e-3});
  }
  // Far from the origin floats have about this spacing, and a camera must not coincide with its target.
  core.radius = std::max(core.radius, 1e-7 * glm::length(core.middle));
  return core;
}

}  // namespace binosplat
