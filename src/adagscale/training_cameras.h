#pragma once
// The cameras in which a model is calibrated if the caller names none.

#include <vector>

#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat::adagscale {

/// Returns the training cameras (test_split) that are beside the model's file and see it. If there are none,
/// returns one that frames the model. In world coordinates.
std::vector<Camera> training_cameras(const Model& model);

}  // namespace binosplat::adagscale
