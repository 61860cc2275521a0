#include "app/bench_plan.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "app/command.h"
#include "app/content_key.h"
#include "app/load_scene.h"
#include "app/option_checks.h"
#include "app/output_options.h"
#include "app/placed.h"
#include "app/report.h"
#include "base/error.h"
#include "base/log.h"
#include "base/output_file.h"
#include "formats/calibration_file.h"
#include "formats/image_file.h"
#include "formats/whole.h"
#include "lab/fields.h"

namespace binosplat::app {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

namespace {

BenchScene open_bench_scene(const BenchOptions& options, const std::string& file) {
  BenchScene scene{is_built_in(file) ? file : fs::path(file).stem().string(), options.scene, {}};
  scene.options.name = file;
  scene.list = listed_cameras(scene.options, options.camera, options.rig);
  const std::string folder =
      options.photos == photos_beside ? photos_folder(options.photos, scene.list) : options.photos;
  scene.photos = photo_source(file, folder, options.exposure);
  return scene;
}

void add_calibrated(const std::string& file, lab::Axes& axes) {
  std::set<std::string> known;
  for (const lab::BenchSettings& settings : axes.settings)
    known.insert(lab::row_of_settings(settings).dump());
  for (const CalibrationEntry& entry : load_calibration(file).entries) {
    lab::BenchSettings settings;
    settings.th = entry.th;
    settings.transmittance = entry.transmittance;
    settings.tolerance = static_cast<float>(entry.tolerance);
    lab::check(file, settings);
    if (known.insert(lab::row_of_settings(settings).dump()).second) axes.settings.push_back(settings);
  }
}

std::vector<std::string> motions_of(const std::vector<std::string>& texts) {
  std::vector<std::string> choices = lab::along_choices();
  std::erase_if(choices, [](const std::string& name) { return name == "views" || name == "turn"; });
  std::vector<std::string> names = separated(texts, [](const std::string&) { return false; });
  for (const std::string& name : names) {
    if (std::ranges::find(choices, name) == choices.end())
      fail("--motion {}: expected one of {}", name, fmt::join(choices, ", "));
  }
  return names;
}

/// Loads the axes (preset or file) that the options name or imply, and replaces values that options give.
lab::Axes axes_of(const BenchOptions& o) {
  const bool along_frames = !o.motions.empty() || !o.camera.path.empty() || o.camera.tour;
  const char* const fitting = along_frames        ? "motion"
                              : o.turn            ? "turn"
                              : o.details.empty() ? "quick"
                                                  : "levels";
  lab::Axes axes = lab::load_axes(o.axes.empty() ? fitting : o.axes);
  if (!o.motions.empty()) axes.along = motions_of(o.motions);
  if (!o.camera.path.empty()) axes.along = {along_path};
  if (o.camera.tour) axes.along = {along_tour};
  if (o.turn && !o.axes.empty()) axes.along = {"turn"};
  if (!o.details.empty()) {
    std::erase_if(axes.settings, [](const lab::BenchSettings& s) { return s.detail.has_value(); });
    for (const std::string& text : o.details) {
      lab::BenchSettings& settings = axes.settings.emplace_back();
      settings.detail = lab::parse_detail(text);
    }
  }
  if (!o.rules.empty()) {
    const std::vector<lab::Rule> rules = rules_of(o.rules);
    std::erase_if(axes.settings, [&](const lab::BenchSettings& s) {
      return !render::is_exact(s.th) && std::ranges::none_of(rules, [&](const lab::Rule& rule) {
        return rule.th == s.th && rule.transmittance == s.transmittance;
      });
    });
  }
  if (o.frames) axes.frames = *o.frames;
  if (!o.size.empty() && !lab::is_size(o.size))
    fail("--size {}: expected own, WxH in px, preview or headset", o.size);
  if (!o.size.empty()) axes.sizes = {o.size};
  if (o.rig.mono) axes.eyes = {1};
  if (!o.calibration.empty()) add_calibrated(o.calibration, axes);
  // With photos, tolerances are searched by the loss against the photos, else by PSNR against exact pictures.
  const bool drops = !o.photos.empty() && std::ranges::any_of(axes.settings, [](const lab::BenchSettings& s) {
    return s.max_drop.has_value();
  });
  const std::size_t erased = std::erase_if(axes.settings, [&](const lab::BenchSettings& s) {
    return drops ? s.min_psnr.has_value() : s.max_drop.has_value();
  });
  if (axes.settings.empty() && erased > 0)
    fail("{}: 'max_drop' needs photos: name them with --photos", axes.name);
  return axes;
}

void add_cases(BenchPlan& plan, std::size_t scene) {
  for (const std::string& along : plan.axes.along) {
    for (const int eyes : plan.axes.eyes) {
      for (const std::string& size : plan.axes.sizes) {
        CasePlan& which = plan.cases.emplace_back(CasePlan{scene, eyes, size, along, plan.points.size()});
        const lab::Row start =
            lab::row_of("scene", plan.scenes[scene].name, "eyes", eyes, "size", size, "along", along);
        for (const lab::BenchSettings& settings : plan.axes.settings) {
          lab::Row& row = plan.points.emplace_back(start);
          row.update(lab::row_of_settings(settings));
          lab::put(row, "name", lab::describe(settings), "family", lab::describe_family(settings));
        }
        if (plan.axes.contributions && along == "views" && eyes == 1) {
          plan.points.push_back(start);
          lab::put(plan.points.back(), "name", "contributions", "family", "contributions");
        }
        which.count = plan.points.size() - which.first;
      }
    }
  }
}

}  // namespace

ordered_json scene_identity(const MeasuredOptions& options, const BenchScene& scene) {
  ordered_json json = {{"name", scene.name}};
  if (scene.name == demo_city_name) {
    json["count"] = city_settings(scene.options).count;
    json["seed"] = city_settings(scene.options).seed;
  } else if (!is_built_in(scene.name)) {
    json["content"] = content_key(fs::path(scene.options.name));
  }
  if (!scene.options.place.empty()) json["place"] = placed_key(scene.options.place);
  json["cameras"] = ordered_json::array();
  for (const Camera& camera : scene.list.cameras) json["cameras"].push_back(camera.name);
  if (!options.camera.views.empty()) json["views"] = options.camera.views;
  if (!scene.list.cameras.empty()) json["poses"] = content_key(scene.list.cameras);
  if (options.camera.near_plane) json["near"] = *options.camera.near_plane;
  json["photos"] = !scene.photos.folder.empty();
  if (!scene.photos.folder.empty()) json["photos_content"] = pictures_key(scene.photos.folder);
  if (scene.photos.exposures.change_any())
    json["exposures_content"] = file_key(scene.photos.exposures.file());
  return json;
}

BenchPlan make_plan(const BenchOptions& options) {
  BenchPlan plan;
  plan.axes = axes_of(options);
  ordered_json scenes = ordered_json::array();
  std::set<std::string> names;
  for (const std::string& file : options.scenes) {
    const BenchScene& scene = plan.scenes.emplace_back(open_bench_scene(options, file));
    if (!names.insert(scene.name).second) fail("two scenes are called {}: bench them one by one", scene.name);
    scenes.push_back(scene_identity(options, scene));
    add_cases(plan, plan.scenes.size() - 1);
  }
  plan.json = std::make_shared<ordered_json>(lab::object(
      "format", "binosplat bench plan", "version", 2, "program", BINOSPLAT_VERSION, "axes_name",
      plan.axes.name, "axes", lab::to_json(plan.axes), "ppd", options.ppd, "floors", options.floors, "path",
      options.camera.path, "tour", options.camera.tour ? options.camera.tour->name : "", "ipd",
      options.rig.ipd, "units_per_metre", options.rig.units_per_metre, "test", options.test, "test_every",
      options.test_every, "scenes", scenes, "points", plan.points));
  return plan;
}

BenchFolder::BenchFolder(fs::path folder, std::shared_ptr<const ordered_json> plan)
    : folder_(std::move(folder)), plan_(std::move(plan)) {
  if (fs::exists(folder_ / "plan.json")) claim();
}

BenchFolder::BenchFolder(fs::path folder) : folder_(std::move(folder)) {
  const ordered_json& plan = *(plan_ = std::make_shared<ordered_json>(load_json(folder_ / "plan.json")));
  if (!plan.is_object() || plan.value("format", "") != "binosplat bench plan" ||
      plan.value("version", 0) != 2 || !plan.contains("points") || !plan["points"].is_array())
    fail("{}: not the plan of a bench run of this version", (folder_ / "plan.json").string());
}

bool BenchFolder::same_plan(const BenchFolder& other) const { return *plan_ == *other.plan_; }
void BenchFolder::claim() const { claim_run(folder_ / "plan.json", *plan_, "points"); }
std::size_t BenchFolder::size() const { return plan_->at("points").size(); }

fs::path BenchFolder::file(std::size_t point) const {
  return folder_ / "points" / fmt::format("{:05}.json", point);
}

bool BenchFolder::has(std::size_t point) const {
  const fs::path picture = fs::path(file(point)).replace_extension(".png");
  return is_whole(file(point)) && (!fs::exists(picture) || is_whole(picture));
}

lab::Point BenchFolder::load(std::size_t point) const {
  const ordered_json json = load_json(file(point));
  const bool good = json.is_object() && json.contains("row") && json["row"].is_object() &&
                    json["row"].contains("device") && json.contains("details") && json["details"].is_array();
  if (!good) fail("{}: not a result of bench: remove the file to measure it again", file(point).string());
  lab::Point measured{json["row"], json["details"]};
  const fs::path picture = fs::path(file(point)).replace_extension(".png");
  if (fs::exists(picture)) measured.picture = load_image(picture);
  return measured;
}

void BenchFolder::save(std::size_t point, const lab::Point& measured) const {
  claim();
  if (measured.picture) save_png(fs::path(file(point)).replace_extension(".png"), *measured.picture);
  save_json(file(point), {{"row", measured.row}, {"details", measured.details}});
}

lab::Results BenchFolder::results() const {
  lab::Results results{plan_->value("axes_name", ""), plan_->value("program", ""), {}};
  for (std::size_t i = 0; i < size(); ++i) {
    lab::Point& point = results.points.emplace_back(lab::Point{plan_->at("points")[i]});
    if (!has(i)) continue;
    lab::Point measured = load(i);
    point.row.update(measured.row);
    point.details = std::move(measured.details);
    point.picture = std::move(measured.picture);
  }
  lab::add_relative_columns(results.points);
  lab::add_means(results.points);
  return results;
}

void BenchFolder::save_results(const lab::Results& results) const {
  claim();
  save_report(folder_, "results.json", to_json(results, *plan_), lab::results_page(results));
  write_file(folder_ / "results.csv", lab::csv(results.points));
  write_file(folder_ / "details.csv", lab::details_csv(results.points));
}

}  // namespace binosplat::app
