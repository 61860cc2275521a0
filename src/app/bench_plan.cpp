#include "app/bench_plan.h"

#include <fmt/core.h>

#include <algorithm>
#include <regex>
#include <set>

#include "app/command.h"
#include "app/content_key.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "demo/city.h"
#include "study/calibration.h"
#include "study/settings.h"

namespace binosplat::app {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

namespace {

BenchScene open(const BenchOptions& options, const std::string& file) {
  BenchScene scene;
  scene.options = options.render;
  scene.options.scene = file;
  scene.name = file.rfind("demo:", 0) == 0 ? file : fs::path(file).stem().string();
  return scene;
}

// What tells a scene from another of the same name.
ordered_json scene_json(const BenchScene& scene) {
  ordered_json json = {{"name", scene.name}};
  if (scene.name == demo_city_name) {
    json["count"] = city_settings(scene.options).count;
    json["seed"] = city_settings(scene.options).seed;
  } else if (scene.name.rfind("demo:", 0) != 0) {
    json["content"] = content_key(fs::path(scene.options.scene));
  }
  json["cameras"] = ordered_json::array();
  for (const Camera& camera : scene.list.cameras) json["cameras"].push_back(camera.name);
  if (!scene.options.views.empty()) json["views"] = scene.options.views;
  if (!scene.list.cameras.empty()) json["poses"] = content_key(scene.list.cameras);
  if (scene.options.near_plane) json["near"] = *scene.options.near_plane;
  json["photos"] = !scene.options.photos.empty();
  if (!scene.options.photos.empty()) json["photos_content"] = pictures_key(scene.options.photos);
  return json;
}

void add_cases(BenchPlan& plan, std::size_t scene) {
  for (const int eyes : plan.axes.eyes) {
    for (const std::string& size : plan.axes.sizes) {
      plan.cases.push_back({scene, eyes, size, plan.json["points"].size()});
      for (const render::FrameSettings& settings : plan.axes.settings) {
        plan.json["points"].push_back({{"scene", plan.scenes[scene].name},
                                       {"eyes", eyes},
                                       {"size", size},
                                       {"name", study::describe(settings)},
                                       {"family", study::describe_family(settings)},
                                       {"settings", study::to_json(settings)}});
      }
    }
  }
}

/// A calibration's ways to draw, with the losses as they are, after the axes' own.
void add_calibrated(const std::string& file, study::Axes& axes) {
  std::set<std::string> known;
  for (const render::FrameSettings& settings : axes.settings) known.insert(study::to_json(settings).dump());
  for (const study::CalibrationEntry& entry : study::load_calibration(file).entries) {
    render::FrameSettings settings;
    settings.th = entry.th;
    settings.transmittance = entry.transmittance;
    settings.loss = static_cast<float>(entry.loss);
    study::check(file, settings);
    if (known.insert(study::to_json(settings).dump()).second) axes.settings.push_back(settings);
  }
}

}  // namespace

ordered_json load_json(const fs::path& path) {
  const MappedFile file(path);
  const auto bytes = file.bytes();
  ordered_json json =
      ordered_json::parse(reinterpret_cast<const char*>(bytes.data()),
                          reinterpret_cast<const char*>(bytes.data()) + bytes.size(), nullptr, false);
  if (json.is_discarded()) fail("{}: not JSON, or cut short", path.string());
  return json;
}

RenderOptions case_options(const BenchScene& scene, const BenchCase& which) {
  RenderOptions options = scene.options;
  options.mono = which.eyes == 1;
  if (options.views.empty() && scene.list.listed) options.views = {"all"};
  if (which.size == "preview" || which.size == "headset") {
    options.preset = which.size;
  } else if (which.size != "own") {
    const std::size_t cross = which.size.find('x');
    options.size = {std::stoi(which.size), std::stoi(which.size.substr(cross + 1))};
  }
  return options;
}

BenchPlan make_plan(const BenchOptions& options) {
  BenchPlan plan;
  plan.axes = study::load_axes(options.axes);
  if (!options.calibration.empty()) add_calibrated(options.calibration, plan.axes);
  plan.json = {{"format", "binosplat bench plan"},  {"version", 1},
               {"program", BINOSPLAT_VERSION},      {"axes_name", plan.axes.name},
               {"axes", study::to_json(plan.axes)}, {"ppd", options.ppd},
               {"profile", options.profile},        {"scenes", ordered_json::array()},
               {"points", ordered_json::array()}};
  std::set<std::string> names;
  plan.scenes.reserve(options.scenes.size());  // a scene keeps a reference to its options
  for (const std::string& file : options.scenes) {
    BenchScene& scene = plan.scenes.emplace_back(open(options, file));
    scene.scene = open_scene(scene.options);
    if (!names.insert(scene.name).second) fail("two scenes are called {}: bench them one by one", scene.name);
    scene.list = listed_cameras(scene.options, scene.scene.cameras);
    plan.json["scenes"].push_back(scene_json(scene));
    add_cases(plan, plan.scenes.size() - 1);
  }
  return plan;
}

BenchFolder::BenchFolder(fs::path folder, const ordered_json& plan)
    : folder_(std::move(folder)), plan_(plan) {
  const fs::path file = folder_ / "plan.json";
  if (!fs::exists(file)) {
    save_json(file, plan);
    return;
  }
  if (load_json(file) != plan) {
    fail(
        "{} holds the points of another run: other scenes, cameras or photos (by content), axes or another "
        "version (see plan.json). Name another folder with -o, or remove it",
        folder_.string());
  }
}

BenchFolder::BenchFolder(fs::path folder)
    : folder_(std::move(folder)), plan_(load_json(folder_ / "plan.json")) {
  if (!plan_.is_object() || plan_.value("format", "") != "binosplat bench plan" ||
      plan_.value("version", 0) != 1 || !plan_.contains("points") || !plan_["points"].is_array())
    fail("{}: not the plan of a bench run of this version", (folder_ / "plan.json").string());
}

fs::path BenchFolder::file(std::size_t point) const {
  return folder_ / "points" / fmt::format("{:05}.json", point);
}

ordered_json BenchFolder::load(std::size_t point) const {
  ordered_json measured = load_json(file(point));
  const bool good = measured.is_object() && (measured.contains("frame_ms") || measured.contains("problem"));
  if (!good) fail("{}: not a point of bench: remove it, and it is measured again", file(point).string());
  return measured;
}

void BenchFolder::save(std::size_t point, const ordered_json& measured) const {
  save_json(file(point), measured);
}

ordered_json BenchFolder::results() const {
  ordered_json results = {{"format", "binosplat bench"}, {"version", 1}, {"plan", plan_}};
  results["plan"].erase("points");
  results["points"] = plan_["points"];
  for (std::size_t i = 0; i < plan_["points"].size(); ++i) {
    if (has(i)) results["points"][i].update(load(i));
  }
  return results;
}

}  // namespace binosplat::app
