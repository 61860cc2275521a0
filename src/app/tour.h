#pragma once
// render --tour: along the way of a head that goes through a model's cameras.

#include "app/render_options.h"
#include "app/shots.h"

namespace CLI {
class App;
}

namespace binosplat::app {

/// Adds --tour and --seconds.
void add_tour_options(CLI::App& sub, RenderOptions& options);

/// Puts the tour's cameras, one a frame, in the place of those it goes through, and says so. Where they are
/// not given fills in --fps (30 for a video, as for others, else 90 as headsets have) and --units-per-metre
/// (metre_of the cameras; scenes that are built in are in metres), by which the eyes are apart, too. Throws
/// Error where there are not two cameras.
void go_on_tour(RenderOptions& options, bool video, CameraList& list);

}  // namespace binosplat::app
