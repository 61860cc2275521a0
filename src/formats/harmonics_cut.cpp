#include "formats/harmonics_cut.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace binosplat {

float square_sum(std::span<const float, cut_values> coefficients) {
  double sum = 0.0;
  for (const double c : coefficients) sum += c * c;
  return static_cast<float>(sum);
}

std::optional<double> cut_harmonics_db(const Model& model, std::span<const float> square_sums) {
  double changes = 0.0, weights = 0.0;
  for (std::size_t i = 0; i < square_sums.size(); ++i) {
    const glm::dvec3 s(model.scale[i]);
    const double weight = model.opacity[i] * std::max({s.x * s.y, s.y * s.z, s.z * s.x});
    const double change = square_sums[i] / (3.0 * 4.0 * glm::pi<double>());
    if (!std::isfinite(weight * change)) continue;  // such Gaussians are not kept
    changes += weight * change;
    weights += weight;
  }
  if (!(changes > 0.0)) return std::nullopt;
  return -10.0 * std::log10(changes / weights);
}

}  // namespace binosplat
