#pragma once
// Selects, orders and copies Gaussians of models.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/model.h"

namespace binosplat {

/// Returns the Gaussians whose `kept` is not 0. Keeps `left_out`, which counts only invalid Gaussians.
Model with_gaussians(const Model& model, const std::vector<std::uint8_t>& kept);

/// Returns a model without Gaussians and with all other properties.
Model without_gaussians(const Model& model);

/// Appends Gaussians `first` to `first + count - 1` of a model of equal degree.
void append(Model& model, const Model& from, std::size_t first, std::size_t count);

/// Copies Gaussians `first` to `first + count - 1` over those of `to`, of equal degree, from index `at` on.
void copy(const Model& from, std::size_t first, std::size_t count, Model& to, std::size_t at);

/// Returns the Gaussians at these indices, in this order.
Model with_order(const Model& model, std::span<const std::uint32_t> indices);

/// Returns the highest degree with a coefficient of this Gaussian that is not 0.
int degree_in_use(const Model& model, std::size_t i);

/// Zeroes coefficients above each Gaussian's entry in `degrees`. Lowers the degree to the highest in use.
Model with_degrees(const Model& model, const std::vector<std::uint8_t>& degrees);

/// Drops the coefficients above a degree, or adds zeros up to it.
void set_degree(Model& model, int degree);

}  // namespace binosplat
