#pragma once
// The results of `calibrate` for a model: the transmittance bound at each depth, and the tolerance of each
// threshold rule that reaches the requested quality. calibration_file.h reads and writes them.

#include <binosplat/settings.h>

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "scene/model.h"

namespace binosplat::adagscale {

struct CalibrationTarget {
  /// drop: dB lost against the photos, mean over the views. quality: least PSNR of a view against its exact
  /// picture.
  enum class Kind { drop, quality } kind = Kind::quality;
  double db = 40.0;
};

struct CalibrationEntry {
  Threshold threshold = Threshold::squared;
  Transmittance transmittance = Transmittance::one;
  double tolerance = 0.0;   // K or kappa, for the focal length ThresholdCalibration::focal
  double reached_db = 0.0;  // mean over the views of the dB lost or the PSNR
  double worst_db = 0.0;    // the same in the worst view
  std::string worst_view;
  double pairs_removed = 0.0;  // share of the exact frames' pairs, mean over the views
  int evaluations = 0;         // number of tolerances that were tried
  double seconds = 0.0;
};

struct CalibratedView {
  std::string name;
  glm::dvec3 position{0.0};  // world units
};

struct ThresholdCalibration {
  std::string model_name;
  std::size_t gaussians = 0;
  std::uint64_t hash = 0;          // model_hash()
  Perspective perspective;         // used for the views; a depth table is valid only for its kind of depth
  double kernel_px2 = KERNEL_PX2;  // low-pass and anti-aliasing (Training) with which the views were drawn
  bool antialiased = false;
  int width = 0;  // px, of the first view
  int height = 0;
  double focal = 0.0;       // px, mean over the views
  double near_plane = 0.0;  // world units
  CalibrationTarget target;
  double depth_table_seconds = 0.0;
  DepthTable depth_table;
  std::vector<CalibratedView> views;
  double reach = INFINITY;  // world units; covers() holds up to this distance from a calibrated view
  std::vector<CalibrationEntry> entries;
};

/// One line for people: the first entry's tolerance, its quality or loss, and its worst view.
std::string summary_of(const ThresholdCalibration& calibration);

/// Returns a hash of the counts and arrays (not of name, axes or perspective); equal on every machine.
std::uint64_t model_hash(const Model& model);

/// Returns whether this model was calibrated.
bool is_of(const ThresholdCalibration& calibration, const Model& model);

/// Returns whether a camera at `position`, world units, is within the calibration's reach of a calibrated
/// view, whatever its direction is (docs/adagscale.md, "Which views a calibration covers").
bool covers(const ThresholdCalibration& calibration, const glm::dvec3& position);

}  // namespace binosplat::adagscale
