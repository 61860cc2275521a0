#pragma once
// Views that see nothing of a model: whatever is done to it, they look equal, and say nothing.

#include <span>
#include <vector>

#include "gl/context.h"
#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat::lab {

/// Of each camera of the world, whether its exact picture has anything of the model in it. Where no
/// Gaussian's middle tells, a small picture is drawn, and one in its own size only where that is empty.
/// `near_plane` in world units.
std::vector<bool> seeing(gl::Context& context, const Model& model, std::span<const Camera> cameras,
                         double near_plane);

}  // namespace binosplat::lab
