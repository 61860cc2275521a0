#include "app/render/shot_settings.h"

#include <algorithm>
#include <cmath>

#include "base/log.h"
#include "base/statistics.h"
#include "formats/training/calibration_file.h"
#include "measure/depth_table.h"
#include "scene/axes.h"

namespace binosplat::app {

render::CalibratedThreshold calibrated_threshold_of(const DrawingOptions& options) {
  if (options.calibration.empty()) return {};
  render::CalibratedThreshold calibrated(options.calibration, load_calibration(options.calibration));
  calibrated.check(settings_of(options));
  return calibrated;
}

render::FrameSettings settings_of(const render::CalibratedThreshold& calibrated, const Shot& shot,
                                  const render::FrameSettings& asked, const ModelAxes& axes) {
  constexpr double same_focal = 0.05;  // relative; a smaller difference needs no warning
  if (!calibrated.is_calibrated()) return asked;
  const shared::View& view = shot.eyes.front().view;
  const double focal = calibrated.calibration().focal;
  static bool said_far = false, said_scaled = false;
  if (!calibrated.covers(view, axes)) {
    if (!std::exchange(said_far, true))
      log_warning("{} is far from the calibrated views: drawing it exactly, and others like it", shot.name);
  } else if (!asked.tolerance && std::abs(view.lens.x / focal - 1.0) > same_focal &&
             !std::exchange(said_scaled, true)) {
    log_warning(
        "{} has a focal length of {:.0f} px and was calibrated at {:.0f}: the tolerance is scaled, the dB "
        "are rough, and so for others like it",
        shot.name, view.lens.x, focal);
  }
  return calibrated.settings(asked, view, axes);
}

void measure_depths(Settings& settings, const render::CalibratedThreshold& calibrated,
                    const std::shared_ptr<render::GpuModel>& model, const Lens& lens, const CameraList& list,
                    double near_plane) {
  if (settings.transmittance != Transmittance::depth || calibrated.is_calibrated()) return;
  std::vector<shared::View> views;
  for (const std::size_t k : spread_evenly(list.cameras.size(), measure::depth_table_views)) {
    const Camera camera = sized(lens, list.cameras[k]);
    views.push_back(make_view(into_axes(camera, model->model().axes), near_plane));
  }
  log_info("--transmittance depth: measuring {} view{} of {}", views.size(), views.size() == 1 ? "" : "s",
           list.source);
  render::Frame frame(model);
  settings.depth_table = measure::measure_depth_table(
      frame, views, {.order = settings.order, .projection = settings.projection});
}

}  // namespace binosplat::app
