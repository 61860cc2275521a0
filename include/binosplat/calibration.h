#pragma once
// A file of `binosplat calibrate`: how much of a model frames may leave out, by AdaGScale or another rule.
//
//   const binosplat::Calibration calibration("calibration.json", model);
//   // Each frame:
//   renderer.submit(views, placement, calibration.settings(views, placement));

#include <filesystem>
#include <memory>
#include <span>

#include <binosplat/renderer.h>

namespace binosplat {

/// AdaGScale: K and the table by depth come from a calibration.
inline const Settings adagscale{.threshold = Threshold::peripheral, .transmittance = Transmittance::by_depth};

/// What `binosplat calibrate` found for a model. Copies are cheap. Everything here may be called from any
/// thread, and needs no context.
class Calibration {
 public:
  /// Reads the file, and all numbers of the model, to see that it is the one that was calibrated. Throws
  /// Error(bad_input) for what is no such file, and for another model.
  Calibration(const std::filesystem::path& path, const SplatModel& model);

  /// `asked` with the file's table, and, where it has neither a tolerance nor a quality, with the file's
  /// tolerance for its threshold (none: squared) and transmittance, scaled to the first view's focal length.
  /// Exact where the first eye is farther from the calibrated cameras than twice the largest distance between
  /// neighbours of them. Throws Error(bad_input) where the file has nothing for that threshold and
  /// transmittance, or is of another order or projection; and as Renderer::submit() does for views.
  Settings settings(std::span<const View> views, const Placement& placement,
                    const Settings& asked = adagscale) const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

}  // namespace binosplat
