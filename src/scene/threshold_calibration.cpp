#include "scene/threshold_calibration.h"

#include <algorithm>
#include <bit>

namespace binosplat {

std::uint64_t model_hash(const Model& model) {
  std::uint64_t hash = 0xcbf29ce484222325ull;  // FNV-1a over words of four bytes
  const auto add = [&](auto word) { hash = (hash ^ std::bit_cast<std::uint32_t>(word)) * 0x100000001b3ull; };
  add(static_cast<std::uint32_t>(model.count()));
  add(model.degree);
  for (const auto* values : {&model.position, &model.scale}) {
    for (const glm::vec3& v : *values) {
      for (int i = 0; i < 3; ++i) add(v[i]);
    }
  }
  for (const glm::vec4& v : model.rotation) {
    for (int i = 0; i < 4; ++i) add(v[i]);
  }
  for (const float v : model.opacity) add(v);
  for (const float v : model.sh) add(v);
  return hash;
}

bool is_of(const ThresholdCalibration& calibration, const Model& model) {
  return calibration.gaussians == model.count() && calibration.hash == model_hash(model);
}

bool covers(const ThresholdCalibration& calibration, const glm::dvec3& position) {
  return std::ranges::any_of(calibration.views, [&](const CalibratedView& view) {
    return glm::distance(view.position, position) <= calibration.reach;
  });
}

}  // namespace binosplat
