#pragma once
// --tour: a head's path through the cameras; --path: a path through keys.

#include "app/options/options.h"
#include "app/render/shots.h"

namespace binosplat::app {

/// Default frame rate of tours that are not videos, and of measurements along paths.
inline constexpr double headset_fps = 90.0;

/// Replaces the cameras by the tour's cameras, one per frame, and logs the tour. If neither options nor the
/// scene set the units per metre, a metre is one world unit, and the log suggests another number by the
/// distances between cameras (estimated_metre). Throws Error for fewer than two cameras.
CameraList go_on_tour(const SceneOptions& scene, const CameraOptions& camera, const RigOptions& rig,
                      double fps, CameraList list);

/// Returns the frames of a path at `fps`, and logs the path. Interpolates keys (scene/key_path.h), or with
/// --seconds any cameras; an eye pair (heads_from_pairs) is one key. Returns other cameras, and all with
/// --keys, unchanged. Throws Error if `fps` is set for unchanged cameras that are not `played` at this rate.
CameraList go_along_path(const CameraOptions& camera, const std::optional<double>& fps, bool played,
                         CameraList list);

}  // namespace binosplat::app
