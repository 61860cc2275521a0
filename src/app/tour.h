#pragma once
// --tour: a head's path through the cameras; --path: a path through keys.

#include "app/camera_options.h"
#include "app/rig_options.h"
#include "app/shots.h"

namespace binosplat::app {

/// Default frame rate of tours that are not videos, and of measurements along paths.
inline constexpr double headset_fps = 90.0;

/// Adds --tour.
CLI::Option* add_tour_option(CLI::App& sub, CameraOptions& options);
/// Adds --tour, --keys and --seconds.
void add_tour_options(CLI::App& sub, CameraOptions& options);

/// Replaces the cameras by the tour's, one a frame, and logs it. A metre is that of the rig; if unknown, one
/// unit. Then the log also has the metre that the distances of the cameras suggest (estimated_metre). Throws
/// Error for fewer than two cameras.
CameraList go_on_tour(const SceneOptions& scene, const CameraOptions& camera, const RigOptions& rig,
                      double fps, CameraList list);

/// The frames of a path. Keys (scene/key_path.h) are interpolated smoothly at `fps`, and logged; frames stay
/// as they are. A pair of eyes (heads_from_pairs) is one key. Throws Error if options need keys but the file
/// has frames. `fps` is such an option, unless the frames are `played` at it.
CameraList go_along_path(const CameraOptions& camera, const std::optional<double>& fps, bool played,
                         CameraList list);

}  // namespace binosplat::app
