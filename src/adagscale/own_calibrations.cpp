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
  const double db = requested.quality.value_or(static_cast<float>(default_quality));
  CalibratedThreshold& found = found_[{requested.order, requested.projection, requested.transmittance, db}];
  if (!found.is_calibrated()) {
    const std::vector<Camera> cameras = training_cameras(model->model());
    std::vector<CalibrationView> views;
    for (const std::size_t k : spread_evenly(cameras.size(), default_views))
      views.push_back({resized(cameras[k], static_cast<int>(view.width), static_cast<int>(view.height)), {}});
    CalibrationSettings wanted{.target = {.db = db}, .table = {.frame = requested}, .reached = cameras};
    wanted.rules.front().transmittance = requested.transmittance.value_or(Transmittance::depth);
    found = {"of this program", calibrate(model, views, view.anchor.w, wanted)};
    log_info("{}: AdaGScale: {}", model->model().name, summary_of(found.calibration()));
  }
  render::FrameSettings by_k = requested;
  by_k.quality.reset();
  return found.settings(by_k, view, model->model().axes);
}

}  // namespace binosplat::adagscale
