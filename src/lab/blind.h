#pragma once
// Finds views in which nothing of a model is visible. They show no errors and would only dilute means.

#include <span>
#include <vector>

#include "gl/context.h"
#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat::lab {

/// Whether each camera's exact picture shows anything of the model. `cameras` are in the world. Tests for a
/// Gaussian with its middle in view, then draws a small picture, then one in the camera's size. `near_plane`
/// is in world units.
std::vector<bool> seeing(gl::Context& context, const Model& model, std::span<const Camera> cameras,
                         double near_plane);

}  // namespace binosplat::lab
