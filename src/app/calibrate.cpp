// binosplat calibrate: measures a model's tolerances and its transmittance by depth, for render and bench.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/blind.h"
#include "app/command.h"
#include "app/option_checks.h"
#include "app/option_conflicts.h"
#include "app/output_options.h"
#include "app/photos.h"
#include "app/resume.h"
#include "app/shots.h"
#include "base/log.h"
#include "base/progress.h"
#include "formats/calibration_file.h"
#include "lab/calibrate.h"

namespace binosplat::app {

namespace {

struct CalibrateOptions : MeasuredOptions {
  TargetOptions target;
  int views = 16;
  std::optional<int> test_every;  // every Nth view is a test view
  measure::DepthTableSettings table;
  std::string output;
};

void print_calibration(const ThresholdCalibration& c, const CalibrateOptions& o) {
  const bool drop = c.target.kind == CalibrationTarget::Kind::drop;
  fmt::print("{} views of {} x {} px; {}\n", c.views.size(), c.width, c.height,
             drop ? fmt::format("target: at most {} dB lost against the photos", c.target.db)
                  : fmt::format("target: {} dB against the exact pictures", c.target.db));
  fmt::print("transmittance by depth: {} bins over [0, {:.4g}], {:.2f} s\n\n", c.depth_table.bounds.size(),
             c.depth_table.far, c.depth_table_seconds);
  fmt::print("{:<12}{:<8}{:>12}{:>10}{:>10}  {:<14}{:>8}{:>8}\n", "th", "source", "tolerance",
             drop ? "drop dB" : "PSNR dB", "worst dB", "in view", "pairs", "s");
  for (const CalibrationEntry& e : c.entries) {
    fmt::print("{:<12}{:<8}{:>12.5g}{:>10.3f}{:>10.3f}  {:<14}{:>7.1f}%{:>8.2f}\n", th_choices[e.th].name,
               transmittance_choices[e.transmittance].name, e.tolerance, e.reached_db, e.worst_db,
               e.worst_view, -100 * e.pairs_removed, e.seconds);
  }
  fmt::print("\n{}\n", o.output);
}

ExitCode calibrate(const CalibrateOptions& o) {
  check_target("calibrate", "a target", o.target, o);
  if (o.test_every && !o.camera.views.empty())
    fail("--test-every with --view: it names the views: leave one of them out");
  check_output(o.output);
  const PhotoSource photos = photos_of(o);
  const auto choice = [&](const CameraList& list) {
    ViewChoice views{o.camera.views, static_cast<std::size_t>(o.views)};
    if (!views.views.empty()) return views;
    // Of fewer views, one in eight would be the first alone, which `render` draws by default.
    if (o.test_every || list.cameras.size() >= 8) views.without = test_split(list, o.test_every).test;
    if (photographed_cameras(views, o.photos, o.camera.lens, list).empty()) views.without.clear();
    return views;
  };
  const OpenScene scene = open_scene(o.scene, o.camera, no_rig, [&](const CameraList& list) {
    check_photos(o.photos, photographed_cameras(choice(list), o.photos, o.camera.lens, list));
  });
  const ViewChoice chosen = choice(scene.list);
  std::vector<lab::CalibrationView> views = photographed_views(chosen, photos, o.camera.lens, scene.list);
  if (!chosen.without.empty()) {
    log_info("calibrating on {} training views; test views: {}", views.size(),
             test_split(scene.list, o.test_every).how);
  } else if (o.camera.views.empty()) {
    log_info("calibrating on {} views: too few to keep some for tests", views.size());
  }
  const auto context = open_context(o.context);
  leave_out_blind("calibrate", *context, scene.model, scene.near_plane, views);
  const std::vector<lab::Rule> rules = rules_of(o.rules);
  note_scene(o.scene);
  Progress progress("calibrating", lab::calibrated_settings(rules).size());
  ThresholdCalibration found = lab::calibrate(
      *context, scene.model, views, scene.near_plane,
      {o.target.target(), o.table, rules, cache_steps(o.output, identity_of(o.given), *context)},
      [&](std::size_t entries, std::size_t) { progress.update(entries); });
  // Every listed camera is within reach, be it calibrated or not.
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (const Camera& camera : scene.list.cameras) {
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
  CLI::App* sub =
      program.add_subcommand("calibrate", "Find the tolerances at which a model loses as much as you allow");
  const auto o = std::make_shared<CalibrateOptions>();
  sub->add_option("SCENE", o->scene.name, "A model, demo:room or demo:city")->required();
  sub->add_option("-o,--output", o->output, "The file to write")->type_name("CALIB.json")->required();
  add_value(*sub, "--quality", "DB", o->target.quality, quality_range,
            "Target: PSNR against the exact pictures, mean over the views");
  add_value(*sub, "--max-drop", "DB", o->target.max_drop, positive,
            "Target: dB lost against the photos, mean over the views");
  add_photos_options(*sub, *o);
  sub->add_option("--cameras", o->camera.file, "Cameras, if not beside the model")->type_name("FILE");
  add_names_option(*sub, "--view", o->camera.views, "Views by name, instead of --views");
  add_value(*sub, "--views", "N", o->views, range(1, 10000),
            "Number of views, spread evenly over the cameras (16)");
  add_test_every_option(*sub, o->test_every);
  add_size_option(*sub, o->camera.lens);
  choose_explained(*sub, "--order", o->table.order, "How Gaussians are sorted (as the model was trained)",
                   order_choices);
  choose_explained(*sub, "--projection", o->table.projection,
                   "How Gaussians are projected (as the model was trained)", projection_choices);
  add_value(*sub, "--bins", "N", o->table.bins, range(1, 10000),
            "Bins of the table of transmittance by depth (20)");
  add_value(*sub, "--far", "DEPTH", o->table.far, positive,
            "End of the bins, in world units; AdaGScale's is 100 (fits the scene)");
  add_rule_option(*sub, o->rules);
  add_measured_options(*sub, *o);
  sub->footer(
      "To resume an interrupted run, start it again with the same options.\n"
      "Examples:\n"
      "  binosplat calibrate garden.ply --photos images --max-drop 0.3 -o garden.json\n"
      "  binosplat calibrate garden.ply --quality 40 --far 100 -o garden.json\n"
      "  binosplat render garden.ply --calibration garden.json --transmittance last");
  sub->callback([o, sub, &command] {
    check_conflicts(*sub);
    o->given = options_given(*sub);
    command = [o] { return calibrate(*o); };
  });
}

}  // namespace binosplat::app
