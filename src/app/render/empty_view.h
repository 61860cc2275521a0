#pragma once
// Explains to a user why a picture is empty, or lacks what is near.

#include <string>
#include <string_view>

#include "app/render/shots.h"
#include "scene/model.h"

namespace binosplat::app {

/// Returns the likely reason why a shot draws no Gaussian, and the options that help. `elsewhere` ends the
/// message for views that miss the model. `near_plane` is in world units.
std::string why_empty(const Model& model, const Shot& shot, double near_plane,
                      std::string_view elsewhere = ": see --eye and --at, or --orbit 8");

/// Returns about how many Gaussians a shot would show if the near plane did not cut them.
std::size_t count_clipped(const Model& model, const Shot& shot, double near_plane);

}  // namespace binosplat::app
