#include "adagscale/calibration.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>

namespace binosplat::adagscale {

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

std::string summary_of(const ThresholdCalibration& c) {
  const CalibrationEntry& e = c.entries.front();
  const char* const what = c.target.kind == CalibrationTarget::Kind::drop ? "dB lost" : "dB";
  return fmt::format(
      "K = {:.4g}: {:.2f} {} in the worst of {} views, {}, {:.2f} in the mean; {:.1f} % of the pairs are "
      "left out",
      e.tolerance, e.worst_db, what, c.views.size(), e.worst_view, e.reached_db, 100.0 * e.pairs_removed);
}

bool is_of(const ThresholdCalibration& calibration, const Model& model) {
  return calibration.gaussians == model.count() && calibration.hash == model_hash(model);
}

bool covers(const ThresholdCalibration& calibration, const glm::dvec3& position) {
  return std::ranges::any_of(calibration.views, [&](const CalibratedView& view) {
    return glm::distance(view.position, position) <= calibration.reach;
  });
}

}  // namespace binosplat::adagscale
