#pragma once
// What to tell a user whose pictures show nothing.

#include <string>

#include "app/shots.h"
#include "scene/model.h"

namespace binosplat::app {

/// The likely cause that no Gaussian was drawn in a shot, and the options that change it. `near_plane` in
/// world units.
std::string why_empty(const Model& model, const Shot& shot, double near_plane);

}  // namespace binosplat::app
