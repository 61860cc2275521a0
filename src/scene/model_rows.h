#pragma once
// A model from rows of numbers that a program has in memory.

#include <functional>

#include "scene/model.h"

namespace binosplat {

/// The model of `count` Gaussians in a frame of these axes (scene/axes.h), with harmonics of a degree, 0
/// to 3. `row` returns each: scales and opacities as they are drawn. Throws Error naming the array and the
/// row, as in "scales[7]: ...", for values that are no Gaussian.
Model model_of_rows(std::size_t count, int degree, const std::string& axes,
                    const std::function<GaussianValues(std::size_t)>& row);

}  // namespace binosplat
