#pragma once
// What a model is made of, in numbers by which a damaged one is found.

#include <array>
#include <cstddef>
#include <map>

#include "scene/model.h"

namespace binosplat {

struct ModelSummary {
  Bounds all;                             // around all positions, from zero
  Bounds core;                            // core_bounds
  std::array<std::size_t, 10> opacity{};  // Gaussians by tenths of opacity; 1 counts to the last
  /// Gaussians by decades of their largest scale: n for scales from 10^n up to 10^(n+1), world units.
  std::map<int, std::size_t> scale;
  double opacity_median = 0.0;
  double scale_median = 0.0;  // each Gaussian's largest scale counts, world units

  std::size_t invisible = 0;            // opacity below tau, so that no pixel ever sees them
  std::size_t without_size = 0;         // all three scales are 0; in none of the decades
  std::size_t flat = 0;                 // smallest scale below a hundredth of the middle one
  std::size_t needles = 0;              // largest scale over a hundred times the middle one
  std::size_t far = 0;                  // farther from the core's box than five times its diagonal
  std::size_t huge = 0;                 // largest scale over the core's diagonal
  std::array<std::size_t, 4> degree{};  // Gaussians by the highest degree with a coefficient that is not 0
};

/// Throws Error if the model is empty.
ModelSummary summarise(const Model& model);

}  // namespace binosplat
