#include "scene/core.h"

#include <algorithm>

#include "base/error.h"
#include "base/statistics.h"

namespace binosplat {

Core core_of(const Model& model) {
  if (model.count() == 0) fail("{}: the model has no Gaussians to look at", model.name);
  Core core;
  std::vector<double> values(model.count());
  for (int i = 0; i < 3; ++i) {
    std::transform(model.position.begin(), model.position.end(), values.begin(),
                   [&](const glm::vec3& p) { return static_cast<double>(p[i]); });
    core.middle[i] = quantile(values, 0.5);
  }
  std::transform(model.position.begin(), model.position.end(), values.begin(),
                 [&](const glm::vec3& p) { return glm::length(glm::dvec3(p) - core.middle); });
  core.radius = quantile(values, 0.5);
  if (core.radius == 0.0) {  // half of them lie in one point: go by their size
    const glm::vec3& s = model.scale[0];
    core.radius =
        std::max({static_cast<double>(s.x), static_cast<double>(s.y), static_cast<double>(s.z), 1e-3});
  }
  // Far from the origin floats tell no less apart, and a camera must stand beside what it looks at.
  core.radius = std::max(core.radius, 1e-7 * glm::length(core.middle));
  return core;
}

}  // namespace binosplat
