#pragma once
// What calibration finds for a model: the transmittance bound at each depth, and which tolerance of each
// threshold rule costs as much as was asked for (formats/calibration_file.h keeps it).

#include <binosplat/settings.h>

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "scene/model.h"

namespace binosplat {

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

struct ThresholdCalibration {
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
  DepthTable depth_table;
  std::vector<CalibratedView> views;
  std::vector<CalibrationEntry> entries;
};

/// A number that changes with any value of the model but its name; the same on every machine.
std::uint64_t model_hash(const Model& model);

/// Whether the model is the one that was calibrated.
bool is_of(const ThresholdCalibration& calibration, const Model& model);

/// How far from calibrated views the calibration knows what to expect, world units: twice the largest
/// distance of one from its nearest neighbour; infinite for fewer than two. Compares all pairs of views.
double reach_of(const ThresholdCalibration& calibration);

/// Whether a camera at `position`, world units, stands within that reach of a calibrated view.
bool covers(const ThresholdCalibration& calibration, const glm::dvec3& position, double reach);

}  // namespace binosplat
