// binosplat study --levels.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/blind.h"
#include "app/command.h"
#include "app/followed.h"
#include "app/load_scene.h"
#include "app/study_parts.h"
#include "base/error.h"
#include "base/log.h"
#include "base/progress.h"
#include "formats/streamed_sog.h"
#include "lab/bench.h"  // spread_evenly
#include "lab/levels.h"
#include "lab/levels_page.h"
#include "lab/timed_rounds.h"

namespace binosplat::app {

namespace {

constexpr std::size_t shots_wanted = 8;
constexpr int frames_wanted = 24;

double number_of_detail(const DetailRequest& detail) { return detail.db.value_or(detail.apart_px); }

/// From the fewest dB or px on.
std::vector<DetailRequest> parse_details(const std::vector<std::string>& texts) {
  std::vector<DetailRequest> details;
  for (const std::string& text : texts) {
    details.push_back(parse_detail(text));
    if (details.back().db.has_value() != details.front().db.has_value())
      fail("--detail {}: expected all of them in pixels, or all in decibels", fmt::join(texts, ","));
  }
  std::ranges::sort(details, {}, number_of_detail);
  const auto same = [](const DetailRequest& a, const DetailRequest& b) {
    return number_of_detail(a) == number_of_detail(b);
  };
  details.erase(std::unique(details.begin(), details.end(), same), details.end());
  return details;
}

/// A scene, and the cameras that it is seen from.
struct Listed {
  SceneOptions scene;
  CameraList list;
};

/// Throws Error for all that can be known to be wrong before anything is drawn.
Listed listed(const StudyOptions& options, const std::string& name) {
  Listed found{.scene = options.scene};
  found.scene.name = name;
  check(found.scene);
  if (!is_streamed_sog(name))
    fail(
        "--levels: {} is no folder with levels of detail (a lod-meta.json): `binosplat levels MODEL -o DIR` "
        "makes one",
        name);
  const LodFiles files(name);
  for (const DetailRequest& detail : options.details) files.check(detail);
  found.list = listed_cameras(found.scene, options.camera, options.rig);
  if (!found.list.listed)
    fail("--levels: {}; name their file with --cameras", why_no_cameras(found.scene, found.list.known));
  check_views(options.camera.views, options.rig.mono, found.list);
  return found;
}

lab::FollowingModel following_model(gl::Context& context, const DetailRequest& detail,
                                    PictureStream& stream) {
  return {number_of_detail(detail), stream.gpu_model(context, PRECISION_FULL),
          [&stream](std::span<const shared::View> views) {
            stream.settle(views, {});
            return lab::LevelsBrought{stream.gaussians(), stream.reported_db()};
          }};
}

// `model` at some level, which shows as well as another which views see nothing.
std::vector<lab::LevelsShot> shots_of(gl::Context& context, const StudyOptions& options, const Listed& listed,
                                      const Model& model) {
  const CameraOptions& camera = options.camera;
  const double near_plane = near_plane_of(camera, listed.list);
  const std::vector<Shot> all =
      make_shots(views_or_all(camera.views), camera.lens, options.rig, listed.list, near_plane, model.axes);
  const std::size_t wanted = camera.views.empty() ? shots_wanted : all.size();
  std::vector<Shot> chosen;
  for (const std::size_t k : lab::spread_evenly(all.size(), wanted)) chosen.push_back(all[k]);
  leave_out_blind("study --levels", context, model, near_plane, chosen);
  std::vector<lab::LevelsShot> shots;
  for (const Shot& shot : chosen) shots.push_back({shot.name, views_of(shot)});
  return shots;
}

lab::LevelsScene measured(gl::Context& context, const StudyOptions& options, const Listed& listed,
                          int frames) {
  std::vector<std::unique_ptr<PictureStream>> streams;
  std::vector<lab::FollowingModel> models;
  for (const DetailRequest& detail : options.details) {
    SceneOptions scene = listed.scene;
    scene.detail = detail;
    streams.push_back(open_for_shots(scene, {}, false));
    models.push_back(following_model(context, detail, *streams.back()));
  }
  const std::vector<lab::LevelsShot> shots = shots_of(context, options, listed, streams.front()->model());
  lab::LevelsScene scene{.name = listed.scene.name, .finest = streams.front()->files().finest()};
  Progress progress("measuring " + scene.name, shots.size());
  std::size_t done = 0;
  lab::measure_levels(
      scene, shots, models, [&] { return load_scene(listed.scene); }, frames,
      [&] { progress.update(++done); });
  return scene;
}

void print_levels_study(const lab::LevelsStudy& study) {
  fmt::print("{}; times: the median of {} frame{} of a view, in the mean of {} rounds in turns\n",
             study.device, study.frames, study.frames == 1 ? "" : "s", lab::turn_rounds);
  for (const lab::LevelsScene& scene : study.scenes) {
    fmt::print("{}: {} Gaussians at the finest levels, {} view{} of {} x {} x {} px\n", scene.name,
               scene.finest, scene.shots.size(), scene.shots.size() == 1 ? "" : "s", scene.eyes, scene.width,
               scene.height);
  }
  for (const std::string& problem : lab::problems_of(study)) fmt::print("{}\n", problem);
  fmt::print("\n");
  print_table(lab::levels_table(study));
  fmt::print(
      "\nMeans over the views, dB by the mean of squared errors. Predicted: of the eye that loses more. "
      "True: "
      "of both\neyes' pictures against those of the finest levels.\n");
  const lab::Table growth = lab::growth_table(study);
  if (growth.rows.empty()) return;
  fmt::print("\nFrame times, and how they grow from the smallest scene:\n\n");
  print_table(growth);
}

}  // namespace

void add_levels_options(CLI::App& sub, StudyOptions& options) {
  sub.add_flag("--levels", options.levels,
               "What levels of detail lose against the finest, and the time that "
               "they\ntake; of several scenes how that "
               "grows with them");
  sub.add_option_function<std::vector<std::string>>(
         "--detail",
         [&options](const std::vector<std::string>& texts) { options.details = parse_details(texts); },
         "With --levels: as `render --detail` takes them (30dB,35dB,40dB,45dB)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("PX|DB,...");
}

void study_levels(const StudyOptions& options) {
  std::vector<Listed> scenes;
  for (const std::string& name : options.scenes) scenes.push_back(listed(options, name));
  const auto context = open_context_for_all("study", false, options.context);
  lab::LevelsStudy study{.device = lab::device_text(*context),
                         .in_db = options.details.front().db.has_value(),
                         .frames = options.frames.value_or(frames_wanted)};
  for (const Listed& scene : scenes) study.scenes.push_back(measured(*context, options, scene, study.frames));
  print_levels_study(study);
  save(options, lab::to_json(study), lab::levels_page(study));
}

}  // namespace binosplat::app
