#include "app/analyses.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/command.h"
#include "app/drawing.h"
#include "app/open_scene.h"
#include "app/parts.h"
#include "app/photos.h"
#include "app/report.h"
#include "base/log.h"
#include "study/analyses.h"

namespace binosplat::app {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t calibration_views = 16, test_views = 8;

void print(const study::Page& page) {
  for (const study::Section& section : page.sections)
    fmt::print("{}\n  {}\n", section.title, section.problem.empty() ? section.sentence : section.problem);
}

}  // namespace

ExitCode analyse_scene(const AnalysisOptions& options) {
  const fs::path folder = options.output;
  check_output(folder / "study.json");
  const Scene scene = open_scene(options.scene);
  CameraList list = listed_cameras(options.scene, scene.cameras);
  const Model model = scene.model();
  if (!list.listed) list = made_up_cameras(options.scene, model);
  const double near_plane = near_plane_of(options.scene, list, model);

  RenderOptions test = options.scene;
  test.views = options.test;
  const std::vector<study::CalibrationView> tested =
      photographed_views(test, list, model, near_plane, test_views,
                         options.test.empty() ? options.scene.views : std::vector<std::string>{});
  std::vector<std::string> names;
  for (const study::CalibrationView& view : tested) names.push_back(view.camera.name);
  std::vector<study::CalibrationView> calibrated =
      photographed_views(options.scene, list, model, near_plane, calibration_views,
                         options.scene.views.empty() ? names : std::vector<std::string>{});
  if (calibrated.empty()) {
    log_warning("there are no other views than those to test on: losses are found on them, too");
    calibrated = tested;
  }

  const auto context = open_context(options.scene);
  Parts parts;
  const bool photos = !options.scene.photos.empty();
  const study::Analysis analysis = study::analyse(
      *context, model, calibrated, tested,
      {.scene = model.name,
       .near_plane = near_plane,
       .kind = photos ? study::CalibrationTarget::Kind::drop : study::CalibrationTarget::Kind::quality,
       .targets = photos ? std::vector{0.1, 0.2, 0.3, 0.4, 0.5} : std::vector{50.0, 45.0, 40.0, 37.0, 34.0},
       .frames = options.frames},
      [&](const std::string& what, std::size_t done, std::size_t of) { parts.update(what, done, of); });
  const study::Page page = study::analysis_page(analysis);
  save_report(folder, "study.json", to_json(analysis), page);
  print(page);
  fmt::print("\n{}: report.html, study.json\n", folder.string());
  return ExitCode::done;
}

}  // namespace binosplat::app
