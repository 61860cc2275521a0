// binosplat calibrate: measures a model's tolerances and its transmittance by depth, for render and bench.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "adagscale/calibrate.h"
#include "adagscale/calibration_file.h"
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

namespace binosplat::app {

namespace {

adagscale::DepthTableSettings table_settings(const Options& o) {
  return {o.table_bins, o.table_far, o.drawing};
}

void print_calibration(const adagscale::ThresholdCalibration& c, const Options& o) {
  fmt::print("{} views of {} x {} px; {}\n", c.views.size(), c.width, c.height,
             c.target.kind == adagscale::CalibrationTarget::Kind::drop
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
  TargetOptions target = o.target;
  if (!target.max_drop && !target.quality) target.quality = adagscale::default_quality;
  check_target("calibrate", "a target", target, o);
  const PhotoSource photos = photos_of(o);
  const auto choice = [&](const CameraList& list) {
    ViewChoice views = training_choice(
        list, static_cast<std::size_t>(o.split.count.value_or(adagscale::default_views)), o.split.test_every);
    if (!o.camera.views.empty()) views = {o.camera.views};
    if (photographed_cameras(views, o.photos, o.camera.lens, list).empty()) views.without.clear();
    return views;
  };
  CameraList list = listed_cameras(o.scene, o.camera);
  if (list.listed) check_photos(o.photos, photographed_cameras(choice(list), o.photos, o.camera.lens, list));
  const Model model = load_scene(o.scene, {}, list.cameras);
  if (!list.listed) list = generate_cameras(o.scene, o.camera, no_rig, list.hints, model);
  const double near_plane = near_plane_of(o.camera, list, model);
  const ViewChoice chosen = choice(list);
  std::vector<adagscale::CalibrationView> views = photographed_views(chosen, photos, o.camera.lens, list);
  if (!chosen.without.empty()) {
    log_info("calibrating on {} training views; test views: {}", views.size(),
             test_split(list, o.split.test_every).how);
  } else if (o.camera.views.empty()) {
    log_info("calibrating on {} views: too few to keep some for tests", views.size());
  }
  const auto context = open_context(o.context);
  remove_empty_views("calibrate", *context, model, near_plane, views);
  adagscale::CalibrationSettings wanted{
      .target = target.target(), .table = table_settings(o), .reached = list.cameras};
  if (!o.rules.empty()) wanted.rules = rules_of(o.rules);
  protect_scene(o.scene);
  Progress progress("calibrating", wanted.rules.size() * adagscale::search_steps * views.size(), "pictures");
  const adagscale::ThresholdCalibration found =
      adagscale::calibrate(std::make_shared<render::GpuModel>(*context, model), views, near_plane, wanted,
                           [&](std::size_t pictures) { progress.update(pictures); });
  save_json(o.output, json_of(found));
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
              {"calibrate", in::calibrate,
               "Find AdaGScale's K, or another rule's tolerance, at which a model loses as much as you allow",
               "Examples:\n"
               "  binosplat calibrate garden.ply -o garden.json      # AdaGScale's K for 40 dB\n"
               "  binosplat render garden.ply --calibration garden.json\n"
               "  binosplat calibrate garden.ply --photos images --max-drop 0.3 --far 100 -o garden.json\n"
               "  binosplat calibrate garden.ply --quality 45 --rule squared -o squared.json"},
              calibrate);
}

}  // namespace binosplat::app
