#pragma once
// What calibration finds for a model, and the file that keeps it: the transmittance bound at each depth, and
// which tolerance costs as much as was asked for.
//
// The file is JSON: format "binosplat calibration", version 1; model (name, gaussians, hash), order and
// projection that it holds for, width, height, focal_px and near of the views, views (name, position), target
// (drop_db against the photos, or psnr_db against the exact pictures), depth_table (far, upper) and entries:
// th, transmittance, tolerance, and what it reached: reached_db and worst_db of worst_view in the target's
// terms, pairs_removed (share), evaluations, seconds.

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "render/settings.h"
#include "scene/model.h"

namespace binosplat::lab {

struct CalibrationTarget {
  /// dB lost against the photos, mean over the views; or PSNR against the exact pictures, likewise.
  enum class Kind { drop, quality } kind = Kind::quality;
  double db = 40.0;
};

struct CalibrationEntry {
  int th = TH_SQUARED;                    // TH_ of shared/axes.h
  int transmittance = TRANSMITTANCE_ONE;  // TRANSMITTANCE_
  double tolerance = 0.0;                 // K or kappa, at the calibration's focal length
  double reached_db = 0.0;                // the drop, or PSNR: the mean over the views
  double worst_db = 0.0;                  // of the worst view
  std::string worst_view;
  double pairs_removed = 0.0;  // share of the exact frames' pairs, mean over the views
  int evaluations = 0;         // tolerances drawn
  double seconds = 0.0;
};

struct CalibratedView {
  std::string name;
  glm::dvec3 position{0.0};  // world units
};

struct Calibration {
  std::string model_name;
  std::size_t gaussians = 0;
  std::uint64_t hash = 0;   // model_hash()
  Perspective perspective;  // that the views were drawn with; a table of another's depths says nothing
  int width = 0;            // px, of the first view
  int height = 0;
  double focal = 0.0;       // px, mean over the views
  double near_plane = 0.0;  // world units
  CalibrationTarget target;
  double depth_table_seconds = 0.0;
  render::DepthTable depth_table;
  std::vector<CalibratedView> views;
  std::vector<CalibrationEntry> entries;
};

/// A number that changes with any value of the model but its name; the same on every machine.
std::uint64_t model_hash(const Model& model);

nlohmann::ordered_json to_json(const Calibration& calibration);

/// Throws Error naming the file and the key for anything that is not such a file.
Calibration load_calibration(const std::filesystem::path& path);
/// The same from its text; `name` is for errors.
Calibration parse_calibration(const std::string& name, const std::string& text);

/// Whether the model is the one that was calibrated.
bool is_of(const Calibration& calibration, const Model& model);

/// Whether a camera stands where the calibration knows what to expect: within twice the largest distance of a
/// calibrated view from its nearest neighbour. With one view: everywhere.
bool covers(const Calibration& calibration, const glm::dvec3& position);

/// The settings with the tolerance (and table) of the calibration's entry for their th and transmittance, at
/// a focal length in px; nothing if it has none. At another focal length f the tolerance is scaled by (f /
/// focal)^tolerance_power: 2.4 at twice the focal length, where K grew 2.2- and 3.3-fold on two scenes and
/// kappa 1.6- and 2.7-fold. Good for a first picture; calibrate anew where the dB matter.
std::optional<render::FrameSettings> calibrated(const Calibration& calibration,
                                                render::FrameSettings settings, double focal);
constexpr double tolerance_power = 1.25;

}  // namespace binosplat::lab
