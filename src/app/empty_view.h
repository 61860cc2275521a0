#pragma once
// What to tell a user whose pictures show nothing.

#include <string>
#include <string_view>

#include "app/shots.h"
#include "scene/model.h"

namespace binosplat::app {

/// The likely cause that no Gaussian was drawn in a shot, and the options that change it; `elsewhere` is what
/// is said of those that look elsewhere. `near_plane` in world units.
std::string why_empty(const Model& model, const Shot& shot, double near_plane,
                      std::string_view elsewhere = ": see --eye and --at, or --orbit 8");

}  // namespace binosplat::app
