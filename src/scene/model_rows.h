#pragma once
// A model from arrays in memory, for the Python and C++ APIs.

#include <functional>

#include "scene/model.h"

namespace binosplat {

/// Builds a model of `count` Gaussians in the frame `axes` (scene/axes.h), with harmonics of `degree`, 0 to
/// 3. `row` returns each Gaussian, with linear scales and opacities. Throws Error naming the array and the
/// row, as in "scales[7]: ...", for invalid values.
Model model_of_rows(std::size_t count, int degree, const std::string& axes,
                    const std::function<GaussianValues(std::size_t)>& row);

}  // namespace binosplat
