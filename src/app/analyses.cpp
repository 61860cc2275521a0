#include "app/analyses.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/blind.h"
#include "app/command.h"
#include "app/parts.h"
#include "app/photos.h"
#include "app/report.h"
#include "app/resume.h"
#include "base/log.h"
#include "lab/analyses.h"

namespace binosplat::app {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t calibration_views = 16, test_views = 8;

void print_page(const lab::Page& page) {
  for (const lab::Section& section : page.sections)
    fmt::print("{}\n  {}\n", section.title, section.problem.empty() ? section.sentence : section.problem);
}

}  // namespace

ExitCode analyse_scene(const MeasuredOptions& options, const std::vector<std::string>& test, int frames,
                       const fs::path& folder) {
  check_output(folder / "study.json");
  const PhotoSource source = photos_of(options);
  const std::vector<std::string>& named = options.camera.views;
  const ViewChoice to_test{test, test_views, test.empty() ? named : std::vector<std::string>()};
  const OpenScene scene = open_scene(options.scene, options.camera, no_rig, [&](const CameraList& list) {
    check_photos(options.photos, photographed_cameras(to_test, options.photos, options.camera.lens, list));
  });
  const auto views_of = [&](const ViewChoice& choice) {
    return photographed_views(choice, source, options.camera.lens, scene.list);
  };
  // No view serves both: those named for the one are left out of all for the other.
  std::vector<lab::CalibrationView> tested = views_of(to_test);
  std::vector<std::string> names;
  for (const lab::CalibrationView& view : tested) names.push_back(view.camera.name);
  std::vector<lab::CalibrationView> calibrated =
      views_of({named, calibration_views, named.empty() ? names : std::vector<std::string>()});
  const auto context = open_context_for_all("study", true, options.context);
  leave_out_blind("study", *context, scene.model, scene.near_plane, tested);
  leave_out_blind("study", *context, scene.model, scene.near_plane, calibrated);
  if (calibrated.empty()) {
    log_warning("there are no other views than those to test on: tolerances are found on them, too");
    calibrated = tested;
  }

  const fs::path result = folder / "study.json";
  Parts parts;
  const bool photos = !options.photos.empty();
  const lab::Analysis analysis = lab::analyse(
      *context, scene.model, calibrated, tested,
      {.scene = scene.model.name,
       .near_plane = scene.near_plane,
       .kind = photos ? lab::CalibrationTarget::Kind::drop : lab::CalibrationTarget::Kind::quality,
       .targets = photos ? std::vector{0.1, 0.2, 0.3, 0.4, 0.5} : std::vector{50.0, 45.0, 40.0, 37.0, 34.0},
       .frames = frames,
       .rules = rules_of(options.rules),
       .keep = keep_steps(result, options, source.exposures, scene.list, *context)},
      [&](const std::string& what, std::size_t done, std::size_t of) { parts.update(what, done, of); });
  const lab::Page page = lab::analysis_page(analysis);
  save_report(folder, "study.json", to_json(analysis), page);
  forget_steps(result);
  print_page(page);
  fmt::print("\n{}: report.html, study.json\n", folder.string());
  return ExitCode::done;
}

}  // namespace binosplat::app
