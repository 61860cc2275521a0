#pragma once
// Finds views that see nothing of a model: they show no error of anything, and would only dilute means.

#include <span>
#include <vector>

#include "gl/context.h"
#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat::lab {

/// Whether the exact picture of each camera of the world shows anything of the model. A Gaussian whose middle
/// is in view proves it; otherwise a small picture is drawn, and if that is empty one in the camera's own
/// size. `near_plane` in world units.
std::vector<bool> seeing(gl::Context& context, const Model& model, std::span<const Camera> cameras,
                         double near_plane);

}  // namespace binosplat::lab
