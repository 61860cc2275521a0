// binosplat profile: records every frame of a path and explains the slow ones.

#include "app/bench/profile.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "app/bench/report.h"
#include "app/command.h"
#include "app/models/level_options.h"
#include "app/open_context.h"
#include "app/options/checks.h"
#include "app/options/options.h"
#include "app/options/parse.h"
#include "app/render/shot_settings.h"
#include "app/render/shots.h"
#include "app/render/tour.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/progress.h"
#include "lab/bench_settings.h"
#include "lab/profile_run.h"

namespace binosplat::app {

namespace fs = std::filesystem;

namespace {

constexpr double seconds_default = 10.0;
constexpr double max_frames = 1e6, frame_bytes = 4096.0;  // limit of a recording; memory of each frame
constexpr double quality_to_try = 40.0;                   // dB: an error that is hardly visible

/// Frames begun a second; 0: as fast as possible.
double frame_rate(const Options& o) { return o.picture.fps.value_or(headset_fps); }

void check_profile(const Options& o) {
  check(o.scene);
  check(o.drawing);
  check(o.context);
  if (frame_rate(o) > 0.0 && frame_rate(o) < min_fps)
    fail("--fps {:g}: expected 0, or {:g} to 1000", frame_rate(o), min_fps);
  check_foveate(o);
}

/// The frame rate for which poses are computed, also if frames are drawn as fast as possible.
double pose_rate(const Options& o) { return frame_rate(o) > 0.0 ? frame_rate(o) : headset_fps; }

/// Replaces the cameras by the path's frames and returns the name of the path. If no option chooses a path
/// or a view, tours the cameras if the scene has at least two. Returns "" for a head that stands still.
std::string choose_path(Options& o, CameraList& list) {
  const bool stands = !o.camera.views.empty() || o.camera.eye || !list.listed;
  if (!o.camera.path.empty()) {
    list = go_along_path(o.camera, pose_rate(o), true, std::move(list));
    return "path " + o.camera.path;
  }
  if (!stands && !o.camera.tour && list.cameras.size() > 1) o.camera.tour = head_motions()[1];
  if (!o.camera.tour) return "";
  list.path = true;
  if (!o.camera.seconds) o.camera.seconds = seconds_default;
  list = go_on_tour(o.scene, o.camera, o.rig, pose_rate(o), std::move(list));
  return "tour " + o.camera.tour->name;
}

std::string drawing_of(const Options& o, const render::FrameSettings& settings) {
  std::string text = settings.quality ? fmt::format("at about {:g} dB", *settings.quality)
                     : render::is_exact(render::chosen_threshold(settings)) ? "exact"
                                                                            : lab::describe({settings});
  if (o.drawing.foveation) text += ", foveated";
  if (o.scene.detail || o.scene.gpu_memory) text += ", levels of detail follow the views";
  return text;
}

std::vector<std::vector<shared::View>> frames_to_profile(const Options& o, const std::vector<Shot>& shots) {
  std::vector<std::vector<shared::View>> frames;
  const bool moves = shots.size() > 1 || o.camera.along_path();
  const double seconds = o.camera.seconds.value_or(seconds_default);
  const double count =
      moves ? static_cast<double>(shots.size()) : std::max(1.0, std::round(seconds * pose_rate(o)));
  const double most = std::min(max_frames, std::floor(0.5 * memory_bytes() / frame_bytes));
  if (count > most)
    fail(
        "profile: {:.4g} frames, and {:.4g} fit in memory: fewer --seconds, at most {:.4g} at {:g} frames a "
        "second, or a lower --fps",
        count, most, most / pose_rate(o), pose_rate(o));
  if (moves) {
    for (const Shot& shot : shots) frames.push_back(views_of(shot));
  } else {
    frames.assign(static_cast<std::size_t>(count), views_of(shots.front()));
  }
  return frames;
}

struct Profiled {
  std::unique_ptr<gl::Context> context;  // first: destroyed last
  OpenedModel<Stream> opened;
  std::shared_ptr<render::GpuModel> model;
  lab::ProfileInput run;
  lab::Profile profile;
};

void open_profiled(Options o, Profiled& all) {
  adagscale::CalibratedThreshold calibrated = calibrated_threshold_of(o.drawing);
  CameraList list = listed_cameras(o.scene, o.camera, o.rig, find_saved(o.scene));
  check_views(o.camera.views, o.rig.mono, list);
  if (o.camera.views == all_views || view_names(o.camera.views, list).size() > 1)
    fail("profile: --view takes a single camera: name one");
  std::string along = choose_path(o, list);
  all.context = open_context(o.context);
  render::FrameSettings settings = calibrated.with_rule(settings_of(o.drawing));
  all.opened = open_for_frames(o.scene, settings, list.cameras);
  const Model& model = all.opened.model();
  if (!o.camera.along_path()) list = cameras_that_see(o.scene, o.camera, o.rig, std::move(list), model);
  const double near_plane = near_plane_of(o.camera, list, model);
  std::vector<Shot> shots = make_shots(o.camera.views, o.camera.lens, o.rig, list, near_plane, model.axes);
  if (!o.camera.along_path()) shots.resize(1);
  if (along.empty()) along = "standing at " + shots.front().name;
  calibrated.check_drawing(settings, model, near_plane);
  calibrated.check_model(model);
  all.model = all.opened.gpu_model(*all.context, settings.precision);
  measure_adagscale(o, all.model, all.opened.stream != nullptr, list, near_plane, calibrated, settings);
  settings = settings_of(calibrated, shots.front(), settings, model.axes);
  all.run = {frames_to_profile(o, shots), settings, frame_rate(o), o.asks_clock};
  all.profile.facts = {o.scene.name, along, drawing_of(o, settings), lab::device_text(*all.context),
                       all.context->software()};
}

void log_duration(double frame_ms, std::size_t frames) {
  constexpr double min_logged_s = 30.0;
  const double seconds = 1e-3 * frame_ms * static_cast<double>(frames);
  if (seconds > min_logged_s)
    log_info("{} frames take about {}: fewer --seconds or a smaller --size take less", frames,
             spoken_time(seconds));
}

lab::Profile record(const Options& o) {
  Profiled all;
  open_profiled(o, all);
  lab::ProfileDrawer drawer(all.model, all.run, all.opened.stream.get());
  log_duration(drawer.warm_up(), all.run.frames.size());
  {
    Progress progress("profiling", all.run.frames.size(), "frames");
    all.profile.recording = drawer.record([&](std::size_t done) { progress.update(done); });
  }
  all.profile.cpu = drawer.cpu();
  const lab::ProfileSummary summary = lab::summary_of(all.profile);
  for (const std::size_t n : summary.worst) all.profile.pictures.emplace_back(drawer.picture(n));
  if (!all.opened.stream)
    all.profile.saving = drawer.saving(summary.worst[summary.worst.size() / 2], quality_to_try);
  return std::move(all.profile);
}

ExitCode profile(Options o) {
  if (o.camera.lens.preset.empty() && !o.camera.lens.size) o.camera.lens.preset = "headset";
  check_profile(o);
  for (const char* const name : profile_files) check_output(fs::path(o.output) / name);
  const std::vector<lab::Row> before = rows_to_compare(o.older_results);
  const lab::Profile profile = record(o);
  const lab::ProfileSummary summary = lab::summary_of(profile);
  lab::RunComparison found;
  if (!o.older_results.empty()) found = lab::compare_runs(before, {lab::profile_point(profile, summary).row});
  save_profile(o.output, profile, found.lines);
  for (const std::string& line : lab::lines_of(profile, summary)) fmt::print("{}\n", line);
  fmt::print("{}: report.html, trace.json (for ui.perfetto.dev), frames.csv, results.json, results.csv\n",
             o.output);
  if (!o.older_results.empty()) print_comparison(o.older_results, found, o.fail_if_slower);
  return ExitCode::done;
}

}  // namespace

void add_profile(CLI::App& program, Command& command) {
  add_command(program, command,
              {"profile", in::profile, "Time every frame along a path, and report why some are slow",
               "trace.json opens in ui.perfetto.dev and chrome://tracing.\n"
               "Examples:\n"
               "  binosplat profile garden.ply -o out/profile\n"
               "  binosplat profile garden.ply --tour calm --seconds 5 --quality 40 --fps 72\n"
               "  binosplat profile garden.ply --view DSC07956 --fps 0 --compare out/profile/results.json -o "
               "out/new\n"
               "  binosplat profile demo:room --size 320x180 --seconds 2",
               "out/profile"},
              profile);
}

}  // namespace binosplat::app
