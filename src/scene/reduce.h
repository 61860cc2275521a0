#pragma once
// Less of a model, and parts put together.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/model.h"

namespace binosplat {

/// The Gaussians with a `kept` other than 0, in their order. Those that go were good ones: `left_out` stays.
Model with_gaussians(const Model& model, const std::vector<std::uint8_t>& kept);

/// A model without Gaussians that is the same in all else.
Model without_gaussians(const Model& model);

/// Appends Gaussians `first` to `first + count` - 1 of a model of the same degree.
void append(Model& model, const Model& from, std::size_t first, std::size_t count);

/// Puts Gaussians `first` to `first + count` of one model in the place of as many of another of its degree,
/// from `at` on.
void copy(const Model& from, std::size_t first, std::size_t count, Model& to, std::size_t at);

/// The Gaussians at these indices, in this order.
Model with_order(const Model& model, std::span<const std::uint32_t> indices);

/// The highest degree of a Gaussian's harmonics with a coefficient that is not 0.
int degree_in_use(const Model& model, std::size_t i);

/// Sets the coefficients beyond a degree of each Gaussian's own to 0, and lowers the model's degree to the
/// highest that is then in use.
Model with_degrees(const Model& model, const std::vector<std::uint8_t>& degrees);

}  // namespace binosplat
