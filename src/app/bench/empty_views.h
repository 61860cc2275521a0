#pragma once
// Skips or refuses views in which nothing of the model is visible, for commands that measure quality.

#include <string>
#include <vector>

#include "adagscale/calibrate.h"
#include "app/render/shots.h"
#include "gl/context.h"
#include "scene/model.h"

namespace binosplat::app {

/// Throws Error if the model is visible in none of the shots. Tests at most 16, spread evenly.
void require_visible_view(const std::string& command, gl::Context& context, const Model& model,
                          const std::vector<Shot>& shots, double near_plane);

/// Removes the shots whose first eye sees nothing of the model (lab::seeing), and warns with the reason.
/// Throws Error if none is left. `command` names the command in messages; `near_plane` is in world units.
void remove_empty_views(const std::string& command, gl::Context& context, const Model& model,
                        double near_plane, std::vector<Shot>& shots);

/// The same for views.
void remove_empty_views(const std::string& command, gl::Context& context, const Model& model,
                        double near_plane, std::vector<adagscale::CalibrationView>& views);

/// The same for a split. Throws Error if no training view or no validation view is left.
void remove_empty_views(const std::string& command, gl::Context& context, const Model& model,
                        compact::ViewSplit& views);

}  // namespace binosplat::app
