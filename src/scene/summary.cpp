#include "scene/summary.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/statistics.h"
#include "scene/reduce.h"

namespace binosplat {

namespace {

constexpr float thin = 0.01f;
constexpr double far_in_diagonals = 5.0;

void count_scale(ModelSummary& summary, glm::vec3 scale, double diagonal) {
  std::sort(&scale.x, &scale.x + 3);
  if (scale.z == 0.0f) {
    ++summary.without_size;
    return;
  }
  ++summary.scale[static_cast<int>(std::floor(std::log10(scale.z)))];
  summary.flat += scale.x < thin * scale.y ? 1 : 0;
  summary.needles += scale.y < thin * scale.z ? 1 : 0;
  summary.huge += scale.z > diagonal ? 1 : 0;
}

}  // namespace

ModelSummary summarise(const Model& model) {
  if (model.count() == 0) fail("{}: the model has no Gaussians", model.name);
  ModelSummary summary;
  summary.core = core_bounds(model);
  summary.all = all_bounds(model);
  const double diagonal = glm::length(summary.core.high - summary.core.low);
  std::vector<double> opacities, scales;
  for (std::size_t i = 0; i < model.count(); ++i) {
    const glm::dvec3 p = model.axes.origin + glm::dvec3(model.position[i]);
    const glm::dvec3 outside = p - glm::clamp(p, summary.core.low, summary.core.high);
    summary.far += glm::length(outside) > far_in_diagonals * diagonal ? 1 : 0;
    const float opacity = model.opacity[i];
    ++summary.opacity[std::min<std::size_t>(9, static_cast<std::size_t>(10.0f * opacity))];
    summary.invisible += opacity < static_cast<float>(ALPHA_MIN) ? 1 : 0;
    count_scale(summary, model.scale[i], diagonal);
    ++summary.degree[static_cast<std::size_t>(degree_in_use(model, i))];
    opacities.push_back(opacity);
    scales.push_back(std::max({model.scale[i].x, model.scale[i].y, model.scale[i].z}));
  }
  summary.opacity_median = quantile(std::move(opacities), 0.5);
  summary.scale_median = quantile(std::move(scales), 0.5);
  return summary;
}

}  // namespace binosplat
