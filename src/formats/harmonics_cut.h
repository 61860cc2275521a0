#pragma once
// What it costs to leave out harmonics of degree 4, which some trainers write and nothing here draws.

#include <optional>
#include <span>

#include "scene/model.h"

namespace binosplat {

/// The coefficients of a Gaussian of degree 4, all channels: what a reader leaves out.
constexpr std::size_t cut_values = 3 * (25 - 16);

/// The sum of their squares.
float square_sum(std::span<const float, cut_values> coefficients);

/// The PSNR of the model's colours against those with the harmonics that were left out, whose square_sum()s
/// these are, one a Gaussian; nothing where all are 0. The functions are orthonormal on the sphere, so that
/// over all directions a channel's mean squared change is the sum of its squares by 4 pi. An estimate of a
/// picture's: as if each pixel showed one Gaussian, more often those of more opacity and area, from anywhere.
std::optional<double> cut_harmonics_db(const Model& model, std::span<const float> square_sums);

}  // namespace binosplat
