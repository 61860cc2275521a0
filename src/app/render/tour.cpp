#include "app/render/tour.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/options/parse.h"
#include "app/render/outputs.h"
#include "base/error.h"
#include "base/log.h"
#include "scene/key_path.h"

namespace binosplat::app {

CameraList go_on_tour(const SceneOptions& scene, const CameraOptions& camera, const RigOptions& rig,
                      double fps, CameraList list) {
  if (list.cameras.empty()) {
    fail(
        "--tour goes through cameras: {}; name their file with --cameras, or go around the model with "
        "--orbit",
        why_no_cameras(scene, list.hints));
  }
  if (!list.hints.units_per_metre && !is_built_in(scene.name))
    log_info(
        "--tour: a metre is one world unit. Neighbouring cameras are {0:.4g} units apart (median); "
        "--units-per-metre {0:.4g} makes that a metre",
        estimated_metre(list.cameras));
  const std::size_t count = list.cameras.size();
  TourSettings settings{*camera.tour, fps, rig_settings(rig, list.hints).units_per_metre};
  settings.seconds = camera.seconds.value_or(settings.seconds);
  list.cameras = tour(list.cameras, settings);
  log_info("--tour: through {} cameras of {} at up to {} m and {} degrees a second: {} frames, {:.3g} s{}",
           count, list.source, settings.motion.metres_per_second, settings.motion.degrees_per_second,
           list.cameras.size(), static_cast<double>(list.cameras.size()) / fps,
           camera.seconds ? "" : " (--seconds S for only the first S seconds)");
  return list;
}

CameraList go_along_path(const CameraOptions& camera, const std::optional<double>& fps, bool played,
                         CameraList list) {
  if (camera.keys) {
    if (fps && !played)
      fail("--fps: --keys draws each camera of {} as it is: leave one of them out", list.source);
    return list;
  }
  const std::vector<Camera> heads = heads_from_pairs(list.cameras);
  if (!camera.seconds && !are_keys(heads)) {
    if (fps && !played)
      fail("--fps: {} has frames, each drawn as it is; --seconds S goes through them as keys", list.source);
    const bool timed = std::any_of(heads.begin(), heads.end(), [](const Camera& c) { return c.time; });
    if (timed && !times_rise(heads)) {
      log_info(
          "--path: {} frames of {} as they are (not all have times that rise: render --seconds S goes "
          "through them as keys)",
          list.cameras.size(), list.source);
    }
    return list;
  }
  const KeyPath path(heads, camera.seconds);
  const double rate = fps.value_or(video_fps);
  list.cameras = frames_of(path, rate);
  log_info("--path: smoothly through the {} keys of {} in {:.3g} s{}: {} frames, {} a second", heads.size(),
           list.source, path.seconds(),
           camera.seconds ? "" : ", by their times (render --seconds S: in S seconds; --keys: only the keys)",
           list.cameras.size(), rate);
  return list;
}

}  // namespace binosplat::app
