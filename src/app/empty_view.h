#pragma once
// Explains to a user why a picture is empty.

#include <string>
#include <string_view>

#include "app/shots.h"
#include "scene/model.h"

namespace binosplat::app {

/// Returns the likely reason why a shot draws no Gaussian, and the options that help. `elsewhere` ends the
/// message for views that miss the model. `near_plane` is in world units.
std::string why_empty(const Model& model, const Shot& shot, double near_plane,
                      std::string_view elsewhere = ": see --eye and --at, or --orbit 8");

}  // namespace binosplat::app
