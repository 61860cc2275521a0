#pragma once
// Finds views in which nothing of a model is visible. They show no errors, so they would only dilute means.

#include <span>
#include <vector>

#include "gl/context.h"
#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat::lab {

/// Returns for each camera whether its exact picture shows anything of the model. Looks for a Gaussian with
/// its middle in view. If there is none, draws a small picture, and if that is empty, one in the camera's
/// size. `cameras` and `near_plane` are in world coordinates.
std::vector<bool> which_see_model(gl::Context& context, const Model& model, std::span<const Camera> cameras,
                                  double near_plane);

}  // namespace binosplat::lab
