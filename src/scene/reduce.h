#pragma once
// Less of a model.

#include <cstdint>
#include <vector>

#include "scene/model.h"

namespace binosplat {

/// The Gaussians with a `kept` other than 0, in their order. Those that go were good ones: `left_out` stays.
Model with_gaussians(const Model& model, const std::vector<std::uint8_t>& kept);

/// Harmonics up to `degree` only, at most the model's.
Model with_degree(const Model& model, int degree);

/// Sets the coefficients beyond a degree of each Gaussian's own to 0, and lowers the model's degree to the
/// highest that is then in use.
Model with_degrees(const Model& model, const std::vector<std::uint8_t>& degrees);

}  // namespace binosplat
