#pragma once
// What commands that judge do with views that see nothing of the model.

#include <string>
#include <vector>

#include "app/shots.h"
#include "gl/context.h"
#include "lab/calibrate.h"
#include "scene/model.h"

namespace binosplat::app {

/// Throws Error where none of the shots, or of some spread evenly over many, sees anything of the model.
void refuse_blind(const std::string& command, gl::Context& context, const Model& model,
                  const std::vector<Shot>& shots, double near_plane);

/// Leaves out the shots whose first eye sees nothing of the model (lab::seeing). Warns of them, and why;
/// throws Error where none does. `command` is what judges in them, `near_plane` in world units.
void leave_out_blind(const std::string& command, gl::Context& context, const Model& model, double near_plane,
                     std::vector<Shot>& shots);

/// The same for views.
void leave_out_blind(const std::string& command, gl::Context& context, const Model& model, double near_plane,
                     std::vector<lab::CalibrationView>& views);

/// The same for cameras in which something is judged beside what the command is for: all may be left out.
void leave_out_blind(const std::string& command, gl::Context& context, const Model& model, double near_plane,
                     std::vector<Camera>& cameras);

/// The same for each task of a split: those that weigh or are fitted, and those held back. Test views decide
/// nothing, and may all be left out.
void leave_out_blind(const std::string& command, gl::Context& context, const Model& model,
                     lab::ViewSplit& views);

}  // namespace binosplat::app
