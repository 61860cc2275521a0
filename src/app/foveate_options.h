#pragma once
// `render --foveate`: an exact inset at the gaze, and fewer pixels around the inset.

#include <optional>

#include "app/cli.h"
#include "stereo/foveate.h"

namespace binosplat::app {

void add_foveate_option(CLI::App& sub, std::optional<stereo::Foveation>& foveate);

}  // namespace binosplat::app
