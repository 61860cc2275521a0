#pragma once
// AdaGScale's analyses (Jo et al.: figures 2, 4 to 6 and 8, tables I to IV) on any scene: what contributions
// are worth, what losses found on some views cost on others, and what that gains in pairs and in time.
//
// One JSON object:
//
//   {"format": "binosplat study", "version": 1, "device", "scene", "gaussians", "target": "drop" | "quality",
//    "views": {"calibration": [...], "test": [...]}, "width", "height",
//    "photo_db": {"calibration", "test"}, "depth_table": {"far", "upper"},
//    "contributions": {...}, "systems": [...], "targets": [...]}
//
// contributions: contributions.h. A system has its name, settings and what it costs and takes on the test
// views: mean_db, worst_db, worst_view (the drop against the photos, or PSNR against exact), pairs_removed (a
// share; below 0: more pairs), frame_ms, stages_ms and pairs. An entry of targets has target_db, settings
// (with the loss that was found), name, reached_db (on the calibration views) and the same. Times are medians
// of a view's frames, in the mean over views.

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "study/calibrate.h"
#include "study/page.h"

namespace binosplat::study {

struct AnalysisSettings {
  std::string scene;  // its name
  double near_plane = 0.2;
  CalibrationTarget::Kind kind = CalibrationTarget::Kind::drop;
  std::vector<double> targets;  // dB that losses are found for; the middle one is the systems'
  int frames = 24;              // timed of each setting, a view and round
};

/// `progress(what, done, of)` tells what is under way.
nlohmann::ordered_json analyse(
    gl::Context& context, const Model& model, const std::vector<CalibrationView>& calibration,
    const std::vector<CalibrationView>& test, const AnalysisSettings& settings,
    const std::function<void(const std::string&, std::size_t, std::size_t)>& progress);

/// The page of what analyse() found.
Page analysis_page(const nlohmann::ordered_json& results);

}  // namespace binosplat::study
