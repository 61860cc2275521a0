#include "app/tour.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "app/option_checks.h"
#include "app/outputs.h"
#include "base/error.h"
#include "base/log.h"
#include "scene/key_path.h"

namespace binosplat::app {

namespace {

// Parses the name of a motion, or "1.5,45": metres and degrees a second.
Motion parse_motion(const std::string& text) {
  std::vector<std::string> names;
  for (const Motion& motion : head_motions()) {
    if (motion.name == text) return motion;
    names.push_back(motion.name);
  }
  Motion motion{text};
  char comma = 0;
  std::istringstream in(text);
  in >> motion.metres_per_second >> comma >> motion.degrees_per_second;
  if (!in || comma != ',' || in.peek() != std::istringstream::traits_type::eof() ||
      !(motion.metres_per_second > 0.0) || !(motion.degrees_per_second > 0.0)) {
    fail("--tour {}: expected {}, or metres and degrees a second above 0, as in 1.5,45", text,
         fmt::join(names, ", "));
  }
  return motion;
}

std::string motions_help() {
  std::string lines;
  for (const Motion& motion : head_motions())
    lines += fmt::format("\n  {}: {} m and {} degrees a second", motion.name, motion.metres_per_second,
                         motion.degrees_per_second);
  return lines;
}

}  // namespace

CLI::Option* add_tour_option(CLI::App& sub, CameraOptions& o) {
  return add_parsed(sub, "--tour", "calm|walk|fast|M,DEG", o.tour, parse_motion,
                    "Move through all cameras as a head does, --fps frames a second (90;\nvideos: 30), in "
                    "metres of --units-per-metre; M,DEG: metres and degrees\na second" +
                        motions_help());
}

void add_tour_options(CLI::App& sub, CameraOptions& o) {
  sub.option_defaults()->group("Cameras");
  add_tour_option(sub, o);
  sub.add_flag("--keys", o.keys, "Draw only the keys of --path");
  add_value(sub, "--seconds", "S", o.seconds, seconds_range,
            "Draw only the first S seconds of the tour (all); with --path: take S\nseconds through its keys, "
            "at an even pace (by their times)");
}

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
  list.cameras = naming("--tour: ", [&] { return tour(list.cameras, settings); });
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
