#pragma once
// --tour: along the way of a head that goes through a model's cameras; --path: along keys.

#include "app/camera_options.h"
#include "app/rig_options.h"
#include "app/shots.h"

namespace binosplat::app {

/// Frames a second where nothing says otherwise: of tours but for videos, and of what is studied along a way.
inline constexpr double headset_fps = 90.0;

/// Adds --tour.
CLI::Option* add_tour_option(CLI::App& sub, CameraOptions& options);
/// Adds --tour, --keys and --seconds.
void add_tour_options(CLI::App& sub, CameraOptions& options);

/// The tour's cameras, one a frame, in the place of those that it goes through; says so. A metre is what it
/// is for pictures, one unit where nothing tells; what the cameras' distances would make of it (metre_of) is
/// said. Throws Error where there are not two cameras.
CameraList go_on_tour(const SceneOptions& scene, const CameraOptions& camera, const RigOptions& rig,
                      double fps, CameraList list);

/// The frames of a path: of keys (scene/key_path.h), `fps` a second, those on a smooth way through them, and
/// says so; others are frames as they are. A pair of eyes (heads_of) is one key. Throws Error for options
/// that need keys where there are none, `fps` among them unless all frames are `played` at it.
CameraList go_along_path(const CameraOptions& camera, const std::optional<double>& fps, bool played,
                         CameraList list);

}  // namespace binosplat::app
