#include "app/bench_plan.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "app/command.h"
#include "app/content_key.h"
#include "app/load_scene.h"
#include "app/report.h"
#include "base/error.h"
#include "base/numbers.h"
#include "base/output_file.h"
#include "formats/calibration_file.h"
#include "formats/image_file.h"
#include "formats/whole.h"
#include "lab/fields.h"
#include "lab/settings.h"

namespace binosplat::app {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

namespace {

BenchScene open_bench_scene(const BenchOptions& options, const std::string& file) {
  BenchScene scene{is_built_in(file) ? file : fs::path(file).stem().string(), options.scene, {}};
  scene.options.name = file;
  scene.list = listed_cameras(scene.options, options.camera);
  return scene;
}

void add_cases(BenchPlan& plan, std::size_t scene) {
  for (const int eyes : plan.axes.eyes) {
    for (const std::string& size : plan.axes.sizes) {
      plan.cases.push_back({scene, eyes, size, plan.points.size()});
      for (const lab::BenchSettings& settings : plan.axes.settings) {
        lab::BenchPoint& point = plan.points.emplace_back();
        point.scene = plan.scenes[scene].name;
        point.eyes = eyes;
        point.size = size;
        point.name = lab::describe(settings);
        point.family = lab::describe_family(settings);
        point.settings = lab::named(settings);
      }
    }
  }
}

/// A calibration's ways to draw, with the tolerances as they are, after the axes' own.
void add_calibrated(const std::string& file, lab::Axes& axes) {
  std::set<lab::NamedSettings> known;
  for (const lab::BenchSettings& settings : axes.settings) known.insert(lab::named(settings));
  for (const CalibrationEntry& entry : load_calibration(file).entries) {
    lab::BenchSettings settings;
    settings.th = entry.th;
    settings.transmittance = entry.transmittance;
    settings.tolerance = static_cast<float>(entry.tolerance);
    lab::check(file, settings);
    if (known.insert(lab::named(settings)).second) axes.settings.push_back(settings);
  }
}

}  // namespace

ordered_json scene_identity(const MeasuredOptions& options, const Exposures& exposures,
                            const BenchScene& scene) {
  ordered_json json = {{"name", scene.name}};
  if (scene.name == demo_city_name) {
    json["count"] = city_settings(scene.options).count;
    json["seed"] = city_settings(scene.options).seed;
  } else if (!is_built_in(scene.name)) {
    json["content"] = content_key(fs::path(scene.options.name));
  }
  json["cameras"] = ordered_json::array();
  for (const Camera& camera : scene.list.cameras) json["cameras"].push_back(camera.name);
  if (!options.camera.views.empty()) json["views"] = options.camera.views;
  if (!scene.list.cameras.empty()) json["poses"] = content_key(scene.list.cameras);
  if (options.camera.near_plane) json["near"] = *options.camera.near_plane;
  json["photos"] = !options.photos.empty();
  if (!options.photos.empty()) json["photos_content"] = pictures_key(options.photos);
  if (exposures.change_any()) json["exposures_content"] = file_key(exposures.file());
  return json;
}

RigOptions rig_of(const BenchCase& which) { return {.mono = which.eyes == 1}; }

Lens lens_of(const BenchCase& which) {
  if (which.size == "own") return {};
  if (const auto size = two_numbers(which.size, 'x')) return {.size = glm::ivec2(size->first, size->second)};
  return {.preset = which.size};
}

BenchPlan make_plan(const BenchOptions& options) {
  BenchPlan plan;
  plan.axes = lab::load_axes(options.axes);
  if (!options.calibration.empty()) add_calibrated(options.calibration, plan.axes);
  ordered_json scenes = ordered_json::array();
  std::set<std::string> names;
  for (const std::string& file : options.scenes) {
    const BenchScene& scene = plan.scenes.emplace_back(open_bench_scene(options, file));
    if (!names.insert(scene.name).second) fail("two scenes are called {}: bench them one by one", scene.name);
    plan.photos = photo_source(scene.options.name, options.photos, options.exposure);
    scenes.push_back(scene_identity(options, plan.photos.exposures, scene));
    add_cases(plan, plan.scenes.size() - 1);
  }
  plan.json = std::make_shared<ordered_json>(
      lab::object("format", "binosplat bench plan", "version", 1, "program", BINOSPLAT_VERSION, "axes_name",
                  plan.axes.name, "axes", lab::to_json(plan.axes), "ppd", options.ppd, "profile",
                  options.profile, "far", options.far, "scenes", scenes, "points", plan.points));
  return plan;
}

std::vector<lab::BenchPoint> load_points(const fs::path& path) {
  try {
    const ordered_json points = load_json(path).at("points");
    for (const ordered_json& point : points) {
      point.at("scene");
      point.at("settings");
    }
    return points.get<std::vector<lab::BenchPoint>>();
  } catch (const ordered_json::exception& error) {
    fail("--compare {}: not the results.json of a bench run: {}", path.string(), error.what());
  }
}

BenchFolder::BenchFolder(fs::path folder, std::shared_ptr<const ordered_json> plan)
    : folder_(std::move(folder)), plan_(std::move(plan)) {
  claim_run(folder_ / "plan.json", *plan_, "points");
}

BenchFolder::BenchFolder(fs::path folder) : folder_(std::move(folder)) {
  const ordered_json& plan = *(plan_ = std::make_shared<ordered_json>(load_json(folder_ / "plan.json")));
  if (!plan.is_object() || plan.value("format", "") != "binosplat bench plan" ||
      plan.value("version", 0) != 1 || !plan.contains("points") || !plan["points"].is_array())
    fail("{}: not the plan of a bench run of this version", (folder_ / "plan.json").string());
}

bool BenchFolder::same_plan(const BenchFolder& other) const { return *plan_ == *other.plan_; }
std::size_t BenchFolder::size() const { return plan_->at("points").size(); }

fs::path BenchFolder::file(std::size_t point) const {
  return folder_ / "points" / fmt::format("{:05}.json", point);
}

bool BenchFolder::has(std::size_t point) const {
  const fs::path picture = fs::path(file(point)).replace_extension(".png");
  return is_whole(file(point)) && (!fs::exists(picture) || is_whole(picture));
}

lab::BenchNumbers BenchFolder::load(std::size_t point) const {
  const ordered_json measured = load_json(file(point));
  const fs::path picture = fs::path(file(point)).replace_extension(".png");
  const bool good = measured.is_object() && (measured.contains("frame_ms") || measured.contains("problem"));
  constexpr auto wrong = "{}: not a point of bench: remove it, and it is measured again";
  if (!good) fail(wrong, file(point).string());
  try {
    lab::BenchNumbers numbers = measured;
    if (fs::exists(picture)) numbers.picture = load_image(picture);
    return numbers;
  } catch (const ordered_json::exception&) {
    fail(wrong, file(point).string());
  }
}

void BenchFolder::save(std::size_t point, const lab::BenchNumbers& measured) const {
  if (measured.picture) save_png(fs::path(file(point)).replace_extension(".png"), *measured.picture);
  save_json(file(point), measured);
}

lab::BenchResults BenchFolder::results() const {
  lab::BenchResults results{plan_->value("axes_name", ""), plan_->value("program", ""),
                            plan_->at("points").get<std::vector<lab::BenchPoint>>()};
  for (std::size_t i = 0; i < results.points.size(); ++i) {
    if (has(i)) static_cast<lab::BenchNumbers&>(results.points[i]) = load(i);
  }
  return results;
}

void BenchFolder::save_results(const lab::BenchResults& results) const {
  ordered_json json = {{"format", "binosplat bench"}, {"version", 1}, {"plan", *plan_}};
  json["plan"].erase("points");
  json["points"] = results.points;
  save_report(folder_, "results.json", json, lab::bench_page(results));
  write_file(folder_ / "results.csv", lab::csv(results.points));
}

}  // namespace binosplat::app
