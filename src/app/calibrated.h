#pragma once
// --calibration: which settings a shot is drawn with.

#include <optional>
#include <string>

#include "app/drawing_options.h"
#include "app/shots.h"
#include "lab/calibration.h"
#include "render/settings.h"

namespace binosplat::app {

class CalibratedSettings {
 public:
  /// Reads the options' file, if they name one; it must have an entry for what they ask for (else: Error).
  explicit CalibratedSettings(const DrawingOptions& options);

  /// A file of another model is not gone by: a warning says so. Throws Error where frames of these settings
  /// have another order or projection than the file. To be called before of().
  void check_model(const Model& model, const render::FrameSettings& settings);

  /// `settings` with the file's tolerance, unless they have one of their own, and its transmittance by depth;
  /// as they are without a file. Exact for a
  /// shot that is far from the calibrated views, and for another model: a warning says so.
  render::FrameSettings of(const Shot& shot, render::FrameSettings settings) const;

 private:
  std::string file_;
  std::optional<lab::Calibration> calibration_;
  bool other_model_ = false, own_tolerance_ = false;
};

}  // namespace binosplat::app
