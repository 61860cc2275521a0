#pragma once
// Calibrates a model while it is drawn, for programs whose settings name AdaGScale without K.

#include <map>
#include <memory>
#include <optional>
#include <tuple>

#include "adagscale/calibrated_threshold.h"
#include "render/gpu_model.h"

namespace binosplat::adagscale {

/// The calibrations of one model, one for each order, projection and quality that frames request.
class OwnCalibrations {
 public:
  /// If lacks_k(requested), returns the settings with K for their quality (none: 40 dB), as
  /// CalibratedThreshold::settings() does. The first frame of a kind finds K in up to 16 training_cameras()
  /// of its size, which takes about a hundred frames, and logs it. `view` is the frame's first view.
  render::FrameSettings settings(const render::FrameSettings& requested,
                                 const std::shared_ptr<render::GpuModel>& model, const shared::View& view);

 private:
  using Kind = std::tuple<std::optional<Order>, std::optional<Projection>, std::optional<Transmittance>,
                          std::optional<float>>;
  std::map<Kind, CalibratedThreshold> found_;
};

}  // namespace binosplat::adagscale
