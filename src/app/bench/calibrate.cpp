// binosplat calibrate: measures a model's tolerances and its transmittance by depth, for render and bench.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/bench/empty_views.h"
#include "app/bench/photos.h"
#include "app/bench/report.h"
#include "app/command.h"
#include "app/models/load_scene.h"
#include "app/open_context.h"
#include "app/options/options.h"
#include "app/options/parse.h"
#include "app/render/resume.h"
#include "app/render/shots.h"
#include "base/choices.h"
#include "base/log.h"
#include "base/progress.h"
#include "formats/training/calibration_file.h"
#include "lab/calibrate.h"

namespace binosplat::app {

namespace {

measure::DepthTableSettings table_settings(const Options& o) {
  return {o.table_bins, o.table_far, o.drawing.order, o.drawing.projection};
}

void print_calibration(const ThresholdCalibration& c, const Options& o) {
  fmt::print("{} views of {} x {} px; {}\n", c.views.size(), c.width, c.height,
             c.target.kind == CalibrationTarget::Kind::drop
                 ? fmt::format("target: at most {} dB lost against the photos", c.target.db)
                 : fmt::format("target: {} dB against the exact pictures", c.target.db));
  fmt::print("transmittance by depth: {} bins over [0, {:.4g}], {:.2f} s\n\n", c.depth_table.bounds.size(),
             c.depth_table.far, c.depth_table_seconds);
  std::vector<lab::Row> entries = json_of(c)["entries"];
  for (lab::Row& entry : entries) entry["pairs_removed"] = 100.0 * lab::number(entry, "pairs_removed");
  print_table(entries, {"threshold", "transmittance", "tolerance", "reached_db", "worst_db", "worst_view",
                        "pairs_removed", "seconds"});
  fmt::print("\n{}\n", o.output);
}

ExitCode calibrate(const Options& o) {
  check_target("calibrate", "a target", o.target, o);
  const PhotoSource photos = photos_of(o);
  const auto choice = [&](const CameraList& list) {
    ViewChoice views{o.camera.views, static_cast<std::size_t>(o.split.count.value_or(16))};
    if (!views.views.empty()) return views;
    // Of fewer views, one in eight would be the first alone, which `render` draws by default.
    if (o.split.test_every || list.cameras.size() >= 8)
      views.without = test_split(list, o.split.test_every).test;
    if (photographed_cameras(views, o.photos, o.camera.lens, list).empty()) views.without.clear();
    return views;
  };
  CameraList list = listed_cameras(o.scene, o.camera);
  if (list.listed) check_photos(o.photos, photographed_cameras(choice(list), o.photos, o.camera.lens, list));
  const Model model = load_scene(o.scene, {}, list.cameras);
  if (!list.listed) list = generate_cameras(o.scene, o.camera, no_rig, list.hints, model);
  const double near_plane = near_plane_of(o.camera, list, model);
  const ViewChoice chosen = choice(list);
  std::vector<lab::CalibrationView> views = photographed_views(chosen, photos, o.camera.lens, list);
  if (!chosen.without.empty()) {
    log_info("calibrating on {} training views; test views: {}", views.size(),
             test_split(list, o.split.test_every).how);
  } else if (o.camera.views.empty()) {
    log_info("calibrating on {} views: too few to keep some for tests", views.size());
  }
  const auto context = open_context(o.context);
  remove_empty_views("calibrate", *context, model, near_plane, views);
  const std::vector<lab::ThresholdVariant> rules = rules_of(o.rules);
  protect_scene(o.scene);
  Progress progress("calibrating", lab::calibrated_settings(rules).size());
  ThresholdCalibration found = lab::calibrate(
      *context, model, views, near_plane,
      {o.target.target(), table_settings(o), rules, cache_steps(o.output, identity_of(o.given), *context)},
      [&](std::size_t entries, std::size_t) { progress.update(entries); });
  // Every listed camera is within reach, be it calibrated or not.
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (const Camera& camera : list.cameras) {
    low = glm::min(low, camera.position);
    high = glm::max(high, camera.position);
  }
  if (low != high) found.reach = glm::distance(low, high);
  save_json(o.output, json_of(found));
  forget_steps(o.output);
  print_calibration(found, o);
  // A tolerance fits one picture size. render warns if the size differs.
  if (o.camera.lens.size)
    log_info(
        "these tolerances are for pictures of {} x {} px: larger ones lose less than the target, smaller "
        "ones more",
        found.width, found.height);
  return ExitCode::done;
}

}  // namespace

void add_calibrate(CLI::App& program, Command& command) {
  add_command(program, command,
              {"calibrate", in::calibrate, "Find the tolerances at which a model loses as much as you allow",
               "To resume an interrupted run, start it again with the same options.\n"
               "Examples:\n"
               "  binosplat calibrate garden.ply --photos images --max-drop 0.3 -o garden.json\n"
               "  binosplat calibrate garden.ply --quality 40 --far 100 -o garden.json\n"
               "  binosplat render garden.ply --calibration garden.json --transmittance last"},
              calibrate);
}

}  // namespace binosplat::app
