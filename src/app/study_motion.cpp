// binosplat study --motion.

#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/blind.h"
#include "app/command.h"
#include "app/load_scene.h"
#include "app/option_checks.h"
#include "app/parts.h"
#include "app/study_parts.h"
#include "app/tour.h"
#include "base/choices.h"
#include "base/error.h"
#include "lab/motion.h"
#include "lab/motion_page.h"
#include "lab/rule.h"
#include "lab/settings.h"
#include "scene/tour.h"

namespace binosplat::app {

using lab::Rule;

namespace {

constexpr const char* still_name = "still";
constexpr std::size_t segments_default = 3;

/// What a metre is in world units, and why.
struct Metre {
  double units = 1.0;
  std::string source = "nothing says otherwise";
};

/// What is driven through: the model, the rig, and the cameras that the paths are made of.
struct Driven {
  std::shared_ptr<const Model> model;
  CameraList list;
  double near_plane = 0.0;
  Metre metre;
  Lens lens;
  RigOptions rig;
};

// As render has it.
Metre metre(const StudyOptions& options, const Known& known) {
  if (options.rig.units_per_metre) return {*options.rig.units_per_metre, "--units-per-metre"};
  if (known.units_per_metre) return {*known.units_per_metre, "the scene's metersPerUnit"};
  return {};
}

Driven open_driven(const StudyOptions& options) {
  Driven driven{.list = listed_cameras(options.scene, options.camera, options.rig),
                .lens = options.camera.lens,
                .rig = options.rig};
  if (!driven.list.listed)
    fail("--motion goes through the cameras of a model: {}; name their file with --cameras, or a --path",
         why_no_cameras(options.scene, driven.list.known));
  if (!options.camera.path.empty())
    driven.list = go_along_path(options.camera, headset_fps, true, std::move(driven.list));
  driven.metre = metre(options, driven.list.known);
  driven.model = std::make_shared<const Model>(load_scene(options.scene, {}, driven.list.cameras));
  driven.near_plane = near_plane_of(options.camera, driven.list);
  return driven;
}

/// The views of cameras that follow one another.
std::vector<std::vector<shared::View>> frames_of(const Driven& driven, std::vector<Camera> cameras) {
  std::vector<std::vector<shared::View>> frames;
  const CameraList list{
      .cameras = std::move(cameras), .path = true, .known = {.units_per_metre = driven.metre.units}};
  for (const Shot& shot :
       make_shots({}, driven.lens, driven.rig, list, driven.near_plane, driven.model->axes))
    frames.push_back(views_of(shot));
  return frames;
}

std::vector<Camera> toured(const Driven& driven, const Motion& motion) {
  return tour(driven.list.cameras, {motion, headset_fps, driven.metre.units});
}

/// How long a stretch of a tour is, without its stop, in frames; and where they begin.
std::size_t stretch_length(const std::vector<Camera>& tour, const MotionOptions& options) {
  return std::min(tour.size(), options.lengths.lead + options.lengths.moving);
}

std::vector<std::size_t> starts_of(const std::vector<Camera>& tour, const MotionOptions& options) {
  return lab::stretch_starts(tour.size(), stretch_length(tour, options),
                             options.segments.value_or(segments_default));
}

lab::MotionPath along_tour(const Driven& driven, const Motion& motion, const MotionOptions& options) {
  lab::MotionPath path{
      motion.name,
      fmt::format("{:g} m/s, {:g} degrees a second", motion.metres_per_second, motion.degrees_per_second),
      {}};
  const std::vector<Camera> cameras = toured(driven, motion);
  for (const std::size_t start : starts_of(cameras, options)) {
    const auto first = cameras.begin() + static_cast<std::ptrdiff_t>(start);
    path.segments.push_back(lab::segment_of(
        frames_of(driven, {first, first + static_cast<std::ptrdiff_t>(stretch_length(cameras, options))}),
        options.lengths));
  }
  return path;
}

std::vector<std::string> all_motions() {
  std::vector<std::string> names = {still_name};
  for (const Motion& motion : head_motions()) names.push_back(motion.name);
  return names;
}

/// A head that stands where calm stretches begin.
lab::MotionPath standing(const Driven& driven, const MotionOptions& options) {
  lab::MotionPath path{still_name, "no motion", {}};
  const std::vector<Camera> cameras = toured(driven, head_motions().front());
  for (const std::size_t start : starts_of(cameras, options))
    path.segments.push_back(lab::still_segment(frames_of(driven, {cameras[start]}).front(), options.lengths));
  return path;
}

std::vector<lab::MotionPath> paths_of(const Driven& driven, const StudyOptions& options) {
  if (!options.camera.path.empty()) {
    if (options.motion.segments || !options.motion.motions.empty() || options.frames)
      fail(
          "--motions, --segments and --frames are for tours through the cameras: --path FILE is gone along "
          "once, whole");
    auto frames = frames_of(driven, driven.list.cameras);
    if (frames.size() < 2) fail("--path {}: a path has two cameras or more", options.camera.path);
    const std::string name = std::filesystem::path(options.camera.path).stem().string();
    return {{name, options.camera.path, {lab::segment_of(std::move(frames), options.motion.lengths)}}};
  }
  std::vector<lab::MotionPath> paths;
  for (const std::string& name : options.motion.motions.empty() ? all_motions() : options.motion.motions) {
    if (name == still_name) {
      paths.push_back(standing(driven, options.motion));
      continue;
    }
    for (const Motion& motion : head_motions()) {
      if (motion.name == name) paths.push_back(along_tour(driven, motion, options.motion));
    }
  }
  return paths;
}

/// A table for a terminal and for documents: dB and % to what can be told apart, the rest to three digits.
void print_motion_study(const lab::MotionStudy& study, const lab::Page& page) {
  fmt::print("{}: {}, {} x {} x {} px; a metre is {:.4g} units ({})\n", study.device, study.scene, study.eyes,
             study.width, study.height, study.units_per_metre, study.metre_source);
  for (const lab::MotionResult& result : study.paths) {
    fmt::print("\n## {}\n{}; {}. Asked for {:g} dB:\n\n", result.path.name, result.path.motion,
               lab::lengths_of(result.path), study.settings.quality);
    print_table(lab::asked_table(result));
    const lab::Table at_target = lab::target_table(result);
    if (at_target.rows.empty()) continue;
    fmt::print("\nAt {:g} dB of the moving frames' true mean:\n\n", study.settings.target);
    print_table(at_target);
  }
  fmt::print(
      "\nTrue: the worse eye's PSNR, of 8-bit pictures against exact ones, {:g} dB for equal ones; its mean,"
      " tenth\npercentile and worst over moving frames. Pairs, with a probe's, times drawn, and ms of all of"
      " these:\nmeans over moving frames; a frame's ms is the median of {} rounds.\n",
      lab::equal_db, study.settings.rounds);
  for (std::size_t k = 0; k < 2; ++k)
    fmt::print("\n{}\n",
               page.sections[k].problem.empty() ? page.sections[k].sentence : page.sections[k].problem);
}

}  // namespace

void add_motion_options(CLI::App& sub, MotionOptions& options) {
  const std::vector<std::string> names = all_motions();
  sub.add_flag("--motion", options.chosen,
               "Rules along moving heads, frame by frame: true quality, pairs and time");
  sub.add_option("--motions", options.motions,
                 fmt::format("With --motion: which; default: {}", fmt::join(names, ",")))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAME,...")
      ->check(CLI::IsMember(names).description(""));
  const auto count = [&](const char* name, std::size_t& into, const char* help) {
    add_value(sub, name, "N", into, range(0, 10000), fmt::format("{} ({})", help, into));
  };
  add_value(sub, "--segments", "N", options.segments, range(1, 1000),
            fmt::format("With --motion: stretches, spread evenly along a tour through the cameras ({})",
                        segments_default));
  count("--lead", options.lengths.lead, "With --motion: frames of a segment before those that count");
  count("--stop", options.lengths.stop, "With --motion: frames at the last pose of a segment that moves");
  add_value(sub, "--rounds", "N", options.rounds, range(1, 100),
            fmt::format("With --motion: in which frames are timed ({})", options.rounds));
  sub.add_flag("--no-equal", options.no_equal,
               "With --motion: without the comparison at one true quality, which takes longest");
}

void study_motion(const StudyOptions& options) {
  const Driven driven = open_driven(options);
  const std::vector<lab::MotionPath> paths = paths_of(driven, options);
  const std::vector<shared::View>& views = paths.front().segments.front().frames.front();
  const std::vector<Rule> rules = rules_of(options.rules);
  const auto context = open_context_for_all("study", true, options.context);
  refuse_blind("study --motion", *context, *driven.model,
               make_shots(all_views, driven.lens, no_rig, driven.list, driven.near_plane, driven.model->axes),
               driven.near_plane);
  lab::MotionStudy study{.device = lab::device_text(*context),
                         .scene = options.scene.name,
                         .gaussians = driven.model->count(),
                         .eyes = views.size(),
                         .width = views.front().width,
                         .height = views.front().height,
                         .frames_per_second = headset_fps,
                         .units_per_metre = driven.metre.units,
                         .metre_source = driven.metre.source,
                         .settings = {.quality = options.quality.value_or(40.0f),
                                      .target = options.target,
                                      .equal = !options.motion.no_equal,
                                      .rounds = options.motion.rounds}};
  {
    Parts parts;
    study.paths = lab::measure_motion(
        *context, *driven.model, paths, rules, study.settings,
        [&](const std::string& what, std::size_t done, std::size_t of) { parts.update(what, done, of); });
  }
  const lab::Page page = lab::motion_page(study);
  print_motion_study(study, page);
  save(options, to_json(study), page);
}

}  // namespace binosplat::app
