#include "adagscale/own_calibrations.h"

#include "adagscale/calibrate.h"
#include "adagscale/training_cameras.h"
#include "base/log.h"
#include "base/statistics.h"

namespace binosplat::adagscale {

render::FrameSettings OwnCalibrations::settings(const render::FrameSettings& requested,
                                                const std::shared_ptr<render::GpuModel>& model,
                                                const shared::View& view) {
  if (!lacks_k(requested)) return requested;
  CalibratedThreshold& found =
      found_[{requested.order, requested.projection, requested.transmittance, requested.quality}];
  if (!found.is_calibrated()) {
    const std::vector<Camera> cameras = training_cameras(model->model());
    std::vector<CalibrationView> views;
    for (const std::size_t k : spread_evenly(cameras.size(), default_views))
      views.push_back({resized(cameras[k], static_cast<int>(view.width), static_cast<int>(view.height)), {}});
    found = {"of this program", find_k(model, views, view.anchor.w, requested, cameras)};
    log_info("{}: AdaGScale: {}", model->model().name, summary_of(found.calibration()));
  }
  render::FrameSettings by_k = requested;
  by_k.quality.reset();
  return found.settings(by_k, view, model->model().axes);
}

}  // namespace binosplat::adagscale
