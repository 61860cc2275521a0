#pragma once
// AdaGScale's analyses (Jo et al.: figures 2, 4 to 6 and 8, tables I to IV) on any scene by the paper's own
// protocol: what contributions are worth, what tolerances found on training views cost on test views, and
// what tolerances tuned on the test views gain in pairs and in time. The table of T_upper is always of the
// training views.

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "lab/calibrate.h"
#include "lab/contributions.h"
#include "lab/page.h"
#include "lab/timed_rounds.h"

namespace binosplat::lab {

constexpr float paper_far = 100.0f;

struct AnalysisSettings {
  std::string scene;  // its name
  double near_plane = 0.2;
  CalibrationTarget::Kind kind = CalibrationTarget::Kind::drop;
  std::vector<double> targets;  // dB that tolerances are found for; the middle one is the systems'
  float far = paper_far;        // world units: where AdaGScale's table by depth ends
  int frames = 24;              // timed of each setting, a view and round
  std::vector<Rule> rules = all_rules();
  Keep keep = {};
};

/// A way to draw, and what it costs and takes on the test views.
struct AnalysedSystem {
  double mean_db = 0.0, worst_db = 0.0;  // the drop against the photos, or PSNR against exact
  std::string worst_view;
  double pairs_removed = 0.0;                   // a share; below 0: more pairs
  std::optional<double> target_db, reached_db;  // where its tolerance was found for a target
  std::string name;
  render::FrameSettings settings;
  Typical times;  // medians of a view's frames, in the mean over views; none of those `found`
  std::optional<Image> picture = {};  // of the first test view, for_page(); of the systems alone
};

struct Analysis {
  std::string device, scene;
  std::size_t gaussians = 0;
  CalibrationTarget::Kind kind = CalibrationTarget::Kind::drop;
  std::vector<std::string> calibration_views, test_views;
  std::string chosen;                                  // how the views were chosen; empty: by name
  int width = 0, height = 0;                           // px
  double calibration_photo_db = 0, test_photo_db = 0;  // of the exact pictures; of a drop
  DepthTable depth_table;                              // the paper's, over [0, far]
  DepthTable fitted_table;  // ours, which ends where 95 % of what is drawn lies nearer
  Contributions contributions;
  std::vector<AnalysedSystem> systems;
  std::vector<AnalysedSystem> found;  // every rule at every target, its tolerance from the calibration views
  std::vector<AnalysedSystem> tuned;  // likewise from the test views themselves: equal drops

  bool drop() const { return kind == CalibrationTarget::Kind::drop; }
};

/// `progress(what, done, of)` tells what is under way.
Analysis analyse(gl::Context& context, const Model& model, const std::vector<CalibrationView>& calibration,
                 const std::vector<CalibrationView>& test, const AnalysisSettings& settings,
                 const std::function<void(const std::string&, std::size_t, std::size_t)>& progress);

/// The members, with units; format "binosplat study", version 2.
nlohmann::ordered_json to_json(const Analysis& analysis);

Page analysis_page(const Analysis& analysis);

/// The systems of several scenes: geometric means of their speed, means of what they lose and remove.
Table means_over_scenes(std::span<const Analysis> analyses);

}  // namespace binosplat::lab
