#pragma once
// Compares a model, attribute by attribute, with the values that an independent decoder read from its file
// (truth.json in the file's folder). Only rounding may differ.

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "scene/model.h"
#include "support/models.h"

namespace binosplat::test {

struct TruthBounds {
  double rotation = 1e-5;  // for each component, up to the quaternion's sign
  bool last = true;        // whether the last coefficient is present; false if degree 4 was cut to 3
};

inline bool near(double a, double b, double bound) { return std::abs(a - b) <= bound; }

inline bool near3(const glm::vec3& a, const nlohmann::json& b, double bound, double relative = 0) {
  bool good = true;
  for (int c = 0; c < 3; ++c) {
    const double expected = b[static_cast<std::size_t>(c)];
    good = good && near(a[c], expected, bound + relative * std::abs(expected));
  }
  return good;
}

/// Returns the first attribute of Gaussian `i` that differs from its entry in truth.json, or "" if none does.
inline std::string difference(const Model& model, std::size_t i, const nlohmann::json& truth,
                              const TruthBounds& bounds = {}) {
  const std::size_t values = model.sh.size() / model.count();
  const float* sh = &model.sh[i * values];
  if (!near3(model.position[i], truth["position"], 1e-5, 1e-5)) return "position";
  for (int c = 0; c < 3; ++c) {
    const double scale = truth["scale"][static_cast<std::size_t>(c)];
    if (!near(std::log(model.scale[i][c]), std::log(scale), 1e-5)) return "scale";
  }
  double same_sign = 0;
  for (int c = 0; c < 4; ++c)
    same_sign += model.rotation[i][c] * truth["rotation_wxyz"][static_cast<std::size_t>(c)].get<double>();
  for (int c = 0; c < 4; ++c) {
    const double expected = truth["rotation_wxyz"][static_cast<std::size_t>(c)];
    if (!near(model.rotation[i][c], std::copysign(1.0, same_sign) * expected, bounds.rotation))
      return "rotation";
  }
  if (!near(model.opacity[i], truth["opacity"], 1e-6)) return "opacity";
  const glm::vec3 dc(sh[0], sh[1], sh[2]);
  if (!near3(0.5f + static_cast<float>(sh_c0) * dc, truth["dc"], 1e-5)) return "dc";
  const auto coefficient = [&](std::size_t k) { return glm::vec3(sh[3 * k], sh[3 * k + 1], sh[3 * k + 2]); };
  for (std::size_t k = 0; truth.contains("sh") && k < truth["sh"].size(); ++k) {
    if (!near3(coefficient(k + 1), truth["sh"][k], 1e-5)) return "sh";
  }
  if (bounds.last && truth.contains("sh_last") && !near3(coefficient(values / 3 - 1), truth["sh_last"], 1e-5))
    return "sh_last";
  return "";
}

/// Compares the values of all Gaussians in truth.json, their bounding box and means, in the same way.
inline std::string difference_of_all(const Model& model, const nlohmann::json& truth) {
  glm::vec3 low(1e30f), high(-1e30f);
  glm::dvec3 scale(0), dc(0);
  double opacity = 0;
  const std::size_t values = model.sh.size() / model.count();
  for (std::size_t i = 0; i < model.count(); ++i) {
    low = glm::min(low, model.position[i]);
    high = glm::max(high, model.position[i]);
    scale += glm::dvec3(model.scale[i]);
    opacity += model.opacity[i];
    for (std::size_t c = 0; c < 3; ++c) dc[static_cast<int>(c)] += 0.5 + sh_c0 * model.sh[i * values + c];
  }
  const double n = static_cast<double>(model.count());
  if (!near3(low, truth["bbox_min"], 1e-5, 1e-5)) return "bbox_min";
  if (!near3(high, truth["bbox_max"], 1e-5, 1e-5)) return "bbox_max";
  if (!near3(scale / n, truth["scale_mean"], 1e-7, 1e-5)) return "scale_mean";
  if (!near3(dc / n, truth["dc_mean"], 1e-5)) return "dc_mean";
  if (!near(opacity / n, truth["opacity_mean"], 1e-6)) return "opacity_mean";
  return "";
}

}  // namespace binosplat::test
