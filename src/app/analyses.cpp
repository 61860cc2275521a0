#include "app/analyses.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/blind.h"
#include "app/command.h"
#include "app/output_options.h"
#include "app/parts.h"
#include "app/photos.h"
#include "app/report.h"
#include "app/resume.h"
#include "app/study_parts.h"
#include "base/log.h"
#include "lab/analyses.h"

namespace binosplat::app {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t calibration_views = 16, most_test_views = 24;

void print_page(const lab::Page& page) {
  for (const lab::Section& section : page.sections)
    fmt::print("{}\n  {}\n", section.title, section.problem.empty() ? section.sentence : section.problem);
}

lab::Analysis analyse_scene(MeasuredOptions options, const AnalysesOptions& analyses,
                            const fs::path& folder) {
  check_output(folder / "study.json");
  if (options.photos == photos_beside)
    options.photos = photos_folder(options.photos, listed_cameras(options.scene, options.camera));
  const PhotoSource source = photos_of(options);
  const std::vector<std::string>& named = options.camera.views;
  const auto held_out = [&](const CameraList& list) {
    return analyses.test.empty() ? hold_out(list, analyses.hold_out) : HeldOut{analyses.test, {}, ""};
  };
  const auto to_test = [&](const CameraList& list) {
    ViewChoice choice{analyses.test, most_test_views, held_out(list).training};
    if (analyses.test.empty()) choice.without.insert(choice.without.end(), named.begin(), named.end());
    return choice;
  };
  const OpenScene scene = open_scene(options.scene, options.camera, no_rig, [&](const CameraList& list) {
    check_photos(options.photos,
                 photographed_cameras(to_test(list), options.photos, options.camera.lens, list));
  });
  const auto views_of = [&](const ViewChoice& choice) {
    return photographed_views(choice, source, options.camera.lens, scene.list);
  };
  // No view serves both: those for tests are left out of all for calibration.
  const HeldOut held = held_out(scene.list);
  std::vector<lab::CalibrationView> tested = views_of(to_test(scene.list));
  if (tested.empty() && !options.photos.empty())
    fail("--photos {}: there is no photo of any view for tests: {}", options.photos, held.how);
  std::vector<lab::CalibrationView> calibrated =
      views_of({named, calibration_views, named.empty() ? held.test : std::vector<std::string>()});
  const auto context = open_context(options.context);
  leave_out_blind("study", *context, scene.model, scene.near_plane, tested);
  leave_out_blind("study", *context, scene.model, scene.near_plane, calibrated);
  if (calibrated.empty()) {
    log_warning("there are no other views than those to test on: tolerances are found on them, too");
    calibrated = tested;
  }
  log_info("{} views for tests{}; tolerances are found on {} others", tested.size(),
           held.how.empty() ? "" : ": " + held.how, calibrated.size());

  const fs::path result = folder / "study.json";
  Parts parts;
  const bool photos = !options.photos.empty();
  lab::Analysis analysis = lab::analyse(
      *context, scene.model, calibrated, tested,
      {.scene = scene.model.name,
       .near_plane = scene.near_plane,
       .kind = photos ? CalibrationTarget::Kind::drop : CalibrationTarget::Kind::quality,
       .targets = photos ? std::vector{0.1, 0.2, 0.3, 0.4, 0.5} : std::vector{50.0, 45.0, 40.0, 37.0, 34.0},
       .far = analyses.far,
       .frames = analyses.frames,
       .rules = rules_of(options.rules),
       .keep = keep_steps(result, options, source.exposures, scene.list, *context)},
      [&](const std::string& what, std::size_t done, std::size_t of) { parts.update(what, done, of); });
  analysis.chosen = held.how;
  const lab::Page page = lab::analysis_page(analysis);
  save_report(folder, "study.json", to_json(analysis), page);
  forget_steps(result);
  print_page(page);
  fmt::print("\n{}: report.html, study.json\n", folder.string());
  return analysis;
}

}  // namespace

ExitCode analyse_scenes(const MeasuredOptions& options, const std::vector<std::string>& scenes,
                        const AnalysesOptions& analyses) {
  if (scenes.size() == 1) return analyse_scene(options, analyses, analyses.folder), ExitCode::done;
  std::vector<lab::Analysis> all;
  for (const std::string& scene : scenes) {
    MeasuredOptions one = options;
    one.scene.name = scene;
    const std::string name =
        is_built_in(scene) ? scene.substr(scene.find(':') + 1) : fs::path(scene).stem().string();
    all.push_back(analyse_scene(one, analyses, analyses.folder / name));
  }
  const lab::Table means = lab::means_over_scenes(all);
  print_table(means);
  lab::Page page{.title = fmt::format("AdaGScale's analyses of {} scenes", all.size()),
                 .sentence = "Speeds are geometric means over the scenes, all else arithmetic ones.",
                 .facts = {{"device", all.front().device}},
                 .sections = {{"means", "Over all scenes (figure 8)", "", means}}};
  for (const lab::Analysis& one : all) page.facts.emplace_back("scene", one.scene);
  save_report(analyses.folder, "study.json", {{"means", means.rows}, {"columns", means.columns}}, page);
  fmt::print("\n{}: report.html, study.json of all\n", analyses.folder.string());
  return ExitCode::done;
}

}  // namespace binosplat::app
