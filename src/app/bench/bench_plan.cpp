#include "app/bench/bench_plan.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "adagscale/calibration_file.h"
#include "app/bench/report.h"
#include "app/command.h"
#include "app/command_line.h"
#include "app/options/checks.h"
#include "app/options/options.h"
#include "app/options/parse.h"
#include "base/error.h"
#include "base/log.h"
#include "base/output_file.h"
#include "demo/demo.h"
#include "formats/containers/complete_files.h"
#include "formats/pictures/image_file.h"
#include "lab/fields.h"

namespace binosplat::app {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

namespace {

BenchScene open_bench_scene(const Options& options, const std::string& file) {
  BenchScene scene{is_built_in(file) ? file : fs::path(file).stem().string(), options.scene, {}};
  scene.options.name = file;
  if (options.bench.scenes.size() == 1) check(scene.options);
  scene.list = listed_cameras(scene.options, options.camera, options.rig, find_saved(scene.options));
  const std::string folder =
      options.photos == photos_beside ? photos_folder(options.photos, scene.list) : options.photos;
  scene.photos = photo_source(file, folder, options.exposure);
  return scene;
}

void add_calibrated(const std::string& file, lab::Suite& suite) {
  std::set<std::string> known;
  for (const lab::BenchSettings& settings : suite.settings)
    known.insert(lab::row_of_settings(settings).dump());
  for (const adagscale::CalibrationEntry& entry : adagscale::load_calibration(file).entries) {
    lab::BenchSettings settings;
    settings.threshold = entry.threshold;
    settings.transmittance = entry.transmittance;
    settings.tolerance = static_cast<float>(entry.tolerance);
    lab::check(file, settings);
    if (known.insert(lab::row_of_settings(settings).dump()).second) suite.settings.push_back(settings);
  }
}

std::vector<std::string> motions_of(const std::vector<std::string>& texts) {
  std::vector<std::string> choices = lab::along_choices();
  std::erase(choices, "views");
  std::vector<std::string> names = separated(texts, [](const std::string&) { return false; });
  for (const std::string& name : names) {
    if (std::ranges::find(choices, name) == choices.end())
      fail("--motion {}: expected one of {}", name, fmt::join(choices, ", "));
  }
  return names;
}

/// Loads the suite (preset or file) that the options name or imply, and replaces values that options give.
lab::Suite suite_of(const Options& o) {
  const bool along_frames = !o.bench.motions.empty() || !o.camera.path.empty() || o.camera.tour;
  const char* const fitting = along_frames ? "motion" : o.bench.details.empty() ? "quick" : "levels";
  lab::Suite suite = lab::load_suite(o.bench.suite.empty() ? fitting : o.bench.suite);
  if (!o.bench.motions.empty()) suite.along = motions_of(o.bench.motions);
  if (!o.camera.path.empty()) suite.along = {along_path};
  if (o.camera.tour) suite.along = {along_tour};
  if (!o.bench.details.empty()) {
    std::erase_if(suite.settings, [](const lab::BenchSettings& s) { return s.detail.has_value(); });
    for (const std::string& text : separated(o.bench.details, [](const std::string&) { return false; })) {
      lab::BenchSettings& settings = suite.settings.emplace_back();
      settings.detail = lab::parse_detail(text);
    }
  }
  if (!o.rules.empty()) {
    const std::vector<render::FrameSettings> rules = rules_of(o.rules);
    std::erase_if(suite.settings, [&](const lab::BenchSettings& s) {
      const Threshold threshold = render::chosen_threshold(s);
      return !render::is_exact(threshold) &&
             std::ranges::none_of(rules, [&](const render::FrameSettings& rule) {
               return rule.threshold == threshold && rule.transmittance == render::chosen_transmittance(s);
             });
    });
  }
  if (o.bench.frames) suite.frames = *o.bench.frames;
  if (!o.bench.size.empty() && !lab::is_size(o.bench.size))
    fail("--size {}: expected own, WxH in px, preview or headset", o.bench.size);
  if (!o.bench.size.empty()) suite.sizes = {o.bench.size};
  if (o.rig.mono) suite.eyes = {1};
  if (!o.drawing.calibration.empty()) add_calibrated(o.drawing.calibration, suite);
  // With photos, tolerances are searched by the loss against the photos, else by PSNR against exact pictures.
  const bool drops =
      !o.photos.empty() &&
      std::ranges::any_of(suite.settings, [](const lab::BenchSettings& s) { return s.max_drop.has_value(); });
  const std::size_t erased = std::erase_if(suite.settings, [&](const lab::BenchSettings& s) {
    return drops ? s.min_psnr.has_value() : s.max_drop.has_value();
  });
  if (suite.settings.empty() && erased > 0)
    fail("{}: 'max_drop' needs photos: name them with --photos", suite.name);
  if (std::ranges::none_of(suite.settings, lab::is_exact)) suite.settings.emplace(suite.settings.begin());
  return suite;
}

void add_cases(BenchPlan& plan, std::size_t scene) {
  for (const std::string& along : plan.suite.along) {
    for (const int eyes : plan.suite.eyes) {
      for (const std::string& size : plan.suite.sizes) {
        CasePlan& which = plan.cases.emplace_back(CasePlan{scene, eyes, size, along, plan.points.size()});
        const lab::Row start =
            lab::object("scene", plan.scenes[scene].name, "eyes", eyes, "size", size, "along", along);
        for (const lab::BenchSettings& settings : plan.suite.settings) {
          lab::Row& row = plan.points.emplace_back(start);
          row.update(lab::row_of_settings(settings));
          lab::put(row, "name", lab::describe(settings), "series", lab::describe_series(settings));
        }
        if (plan.suite.contributions && along == "views" && eyes == 1) {
          plan.points.push_back(start);
          lab::put(plan.points.back(), "name", "contributions", "series", "contributions");
        }
        which.count = plan.points.size() - which.first;
      }
    }
  }
}

}  // namespace

BenchPlan make_plan(const Options& options) {
  BenchPlan plan;
  plan.suite = suite_of(options);
  if ((options.scene.seed || options.scene.count) &&
      std::ranges::count(options.bench.scenes, demo_city_name) == 0)
    fail("--seed and --count are for {}, which is none of the scenes", demo_city_name);
  std::set<std::string> names;
  for (const std::string& file : options.bench.scenes) {
    const BenchScene& scene = plan.scenes.emplace_back(open_bench_scene(options, file));
    if (!names.insert(scene.name).second) fail("two scenes are called {}: bench them one by one", scene.name);
    protect_scene(scene.options);
    protect_photos(scene.photos.folder);
    add_cases(plan, plan.scenes.size() - 1);
  }
  return plan;
}

BenchFolder::BenchFolder(const Options& options, const BenchPlan& plan)
    : folder_(options.output), run_file_(folder_ / "bench-run.json"), plan_(plan), lock_(run_file_) {
  run_ = identity_of(options.given);
  if (fs::exists(run_file_)) check_same_run(run_file_, run_, "points");
}

fs::path BenchFolder::file(std::size_t point) const {
  return folder_ / "points" / fmt::format("{:05}.json", point);
}

bool BenchFolder::has(std::size_t point) const {
  const fs::path picture = fs::path(file(point)).replace_extension(".png");
  return is_complete(file(point)) && (!fs::exists(picture) || is_complete(picture));
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
  claim_run(run_file_, run_, "points");
  if (measured.picture) save_png(fs::path(file(point)).replace_extension(".png"), *measured.picture);
  save_json(file(point), {{"row", measured.row}, {"details", measured.details}});
}

lab::Results BenchFolder::results() const {
  lab::Results results{plan_.suite.name, BINOSPLAT_VERSION, {}};
  for (std::size_t i = 0; i < plan_.points.size(); ++i) {
    lab::Point& point = results.points.emplace_back(lab::Point{plan_.points[i]});
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
  save_report(folder_, "results.json",
              to_json(results, lab::object("suite_name", results.suite, "program", results.program, "suite",
                                           lab::to_json(plan_.suite))),
              lab::results_page(results));
  write_file(folder_ / "results.csv", lab::csv(results.points));
  write_file(folder_ / "details.csv", lab::details_csv(results.points));
}

}  // namespace binosplat::app
