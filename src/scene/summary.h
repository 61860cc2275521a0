#pragma once
// Statistics of a model that expose a damaged one, for `info`.

#include <array>
#include <cstddef>
#include <map>

#include "scene/model.h"

namespace binosplat {

struct ModelSummary {
  Bounds all;                             // around all positions, relative to zero
  Bounds core;                            // core_bounds()
  std::array<std::size_t, 10> opacity{};  // Gaussians in each tenth of opacity; opacity 1 is in the last
  /// Gaussians by decade of their largest scale: entry n counts scales from 10^n up to 10^(n+1) world units.
  std::map<int, std::size_t> scale;
  double opacity_median = 0.0;
  double scale_median = 0.0;  // of each Gaussian's largest scale, world units

  std::size_t invisible = 0;            // opacity below tau, invisible in every pixel
  std::size_t without_size = 0;         // all three scales are 0; not counted in `scale`
  std::size_t flat = 0;                 // smallest scale below a hundredth of the middle one
  std::size_t needles = 0;              // largest scale over a hundred times the middle one
  std::size_t far = 0;                  // distance to the core's box over five times its diagonal
  std::size_t huge = 0;                 // largest scale over the core's diagonal
  std::array<std::size_t, 4> degree{};  // Gaussians by the highest degree with a coefficient that is not 0
};

/// Throws Error if the model is empty.
ModelSummary summarise(const Model& model);

}  // namespace binosplat
