#pragma once
// How much a frame may leave out, where that comes from a calibration of the model.

#include <optional>
#include <string>

#include "render/settings.h"
#include "scene/threshold_calibration.h"
#include "shared/types.h"

namespace binosplat::render {

/// Gives each frame the tolerance and the table of transmittance by depth that a calibration has for its
/// threshold rule. Every program and the library draw by it, so the same file gives the same pictures.
class ThresholdPolicy {
 public:
  /// Settings stay as they are.
  ThresholdPolicy() = default;
  /// `name` is the calibration's in errors: its file.
  ThresholdPolicy(std::string name, ThresholdCalibration calibration)
      : name_(std::move(name)), calibration_(std::move(calibration)), reach_(reach_of(*calibration_)) {}

  bool is_calibrated() const { return calibration_.has_value(); }
  /// Whether the calibration has a tolerance for the rule and the transmittance of these settings.
  bool has_entry(const FrameSettings& asked) const;
  const ThresholdCalibration& calibration() const { return *calibration_; }

  /// Throws Error(bad_input) where the calibration has no entry for the rule and the transmittance that are
  /// asked for.
  void check(const FrameSettings& asked) const;
  /// The same where it is of another order or projection than frames of the model have.
  void check_perspective(const FrameSettings& asked, const Model& model) const;
  /// Throws Error(bad_input) where the calibration is of another model. Reads all of the model's numbers.
  void check_model(const Model& model) const;

  /// Whether a view stands where the calibration knows what to expect (scene/threshold_calibration.h).
  bool covers(const shared::View& view, const ModelAxes& axes) const;

  /// The settings of a frame whose first view this is, in the model's frame of reference. A tolerance or a
  /// quality that is asked for stays, and takes only the table from the calibration; otherwise the entry's
  /// tolerance is scaled by (focal length / calibrated focal length)^1.25: 2.4 at twice the focal length,
  /// where K grew 2.2- and 3.3-fold on two scenes and kappa 1.6- and 2.7-fold. Exact for a view that the
  /// calibration does not cover. Throws as check() does.
  FrameSettings settings(FrameSettings asked, const shared::View& view, const ModelAxes& axes) const;

 private:
  std::string name_;
  std::optional<ThresholdCalibration> calibration_;
  double reach_ = 0.0;  // of the calibration: frames ask for it
};

}  // namespace binosplat::render
