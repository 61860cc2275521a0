#pragma once
// What commands that judge do with views that see nothing of the model.

#include <string>
#include <vector>

#include "app/shots.h"
#include "gl/context.h"
#include "scene/model.h"
#include "study/calibrate.h"

namespace binosplat::app {

/// Which cameras see something of the model (study::seeing). Warns of those that do not, and why; throws
/// Error where none does, unless what is judged in them is not what the command is for. `command` is what
/// judges in them, `near_plane` in world units.
std::vector<bool> seeing_views(const std::string& command, gl::Context& context, const Model& model,
                               const std::vector<Camera>& cameras, double near_plane, bool needs_one = true);

/// Throws Error where none of the shots, or of some spread evenly over many, sees anything of the model.
void refuse_blind(const std::string& command, gl::Context& context, const Model& model,
                  const std::vector<Shot>& shots, double near_plane);

/// Leaves out the shots whose first eye does not, as seeing_views() has it.
void leave_out_blind(const std::string& command, gl::Context& context, const Model& model, double near_plane,
                     std::vector<Shot>& shots);

/// Leaves out the views that do not.
void leave_out_blind(const std::string& command, gl::Context& context, const Model& model, double near_plane,
                     std::vector<study::CalibrationView>& views);

/// The same for each task of a split: those that weigh or are fitted, and those held back. Test views decide
/// nothing, and may all be left out.
void leave_out_blind(const std::string& command, gl::Context& context, const Model& model,
                     study::ViewSplit& views);

}  // namespace binosplat::app
