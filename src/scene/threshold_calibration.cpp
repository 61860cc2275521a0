#include "scene/threshold_calibration.h"

#include <algorithm>
#include <cstring>

namespace binosplat {

namespace {

/// FNV-1a over words of four bytes.
class Hash {
 public:
  void add(std::uint32_t word) { state_ = (state_ ^ word) * 0x100000001b3ull; }
  void add(float value) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof(bits));
    add(bits);
  }
  std::uint64_t state() const { return state_; }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325ull;
};

}  // namespace

std::uint64_t model_hash(const Model& model) {
  Hash hash;
  hash.add(static_cast<std::uint32_t>(model.count()));
  hash.add(static_cast<std::uint32_t>(model.degree));
  for (const auto* values : {&model.position, &model.scale}) {
    for (const glm::vec3& v : *values) {
      for (int i = 0; i < 3; ++i) hash.add(v[i]);
    }
  }
  for (const glm::vec4& v : model.rotation) {
    for (int i = 0; i < 4; ++i) hash.add(v[i]);
  }
  for (const float v : model.opacity) hash.add(v);
  for (const float v : model.sh) hash.add(v);
  return hash.state();
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
