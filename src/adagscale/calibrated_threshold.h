#pragma once
// Derives a frame's tolerance and bounds from a calibration of the model.

#include <optional>
#include <string>

#include "adagscale/calibration.h"
#include "render/frame_settings.h"
#include "shared/types.h"

namespace binosplat::adagscale {

using render::FrameSettings;

/// Whether settings name AdaGScale without a tolerance: a calibration must find K.
bool lacks_k(const Settings& settings);

/// Gives each frame its calibration's tolerance and table of transmittance by depth. Every program and the
/// library use it, so the same file gives the same pictures.
class CalibratedThreshold {
 public:
  /// One without a calibration leaves settings unchanged.
  CalibratedThreshold() = default;
  /// `name` is the calibration's file, for errors.
  CalibratedThreshold(std::string name, ThresholdCalibration calibration)
      : name_(std::move(name)), calibration_(std::move(calibration)) {}

  bool is_calibrated() const { return calibration_.has_value(); }
  /// Whether the calibration has a tolerance for the rule and the transmittance of these settings.
  bool has_entry(const FrameSettings& requested) const;
  const ThresholdCalibration& calibration() const { return *calibration_; }

  /// Returns the settings with the rule and the transmittance of the first entry that has those that they
  /// name. Exact settings, and settings with a tolerance or a quality, need no entry. Throws Error(bad_input)
  /// if there is no such entry.
  FrameSettings with_rule(FrameSettings requested) const;
  /// Throws Error(bad_input) if frames of the model have another order, projection, low-pass, anti-aliasing
  /// or near plane (world units) than the calibration.
  void check_drawing(const FrameSettings& requested, const Model& model, double near_plane) const;
  /// Throws Error(bad_input) if the calibration belongs to another model. Reads all of the model's numbers.
  void check_model(const Model& model) const;

  /// Whether a view is near enough to the calibrated cameras (adagscale/calibration.h).
  bool covers(const shared::View& view, const ModelAxes& axes) const;

  /// The settings of a frame whose first view is `view`, in the model's coordinates. A requested tolerance or
  /// quality stays, and only the table is added. Otherwise scales the entry's tolerance by (focal length /
  /// calibrated focal length)^1.25. At twice the focal length this factor is 2.4; on two scenes the measured
  /// K grew 2.2- and 3.3-fold, and kappa 1.6- and 2.7-fold. Returns exact settings for a view that the
  /// calibration does not cover. Throws as with_rule() does.
  FrameSettings settings(const FrameSettings& requested, const shared::View& view,
                         const ModelAxes& axes) const;

 private:
  std::string name_;
  std::optional<ThresholdCalibration> calibration_;
};

}  // namespace binosplat::adagscale
