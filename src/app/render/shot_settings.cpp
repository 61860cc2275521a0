#include "app/render/shot_settings.h"

#include <algorithm>
#include <cmath>

#include "adagscale/calibrate.h"
#include "adagscale/calibration_file.h"
#include "app/bench/empty_views.h"
#include "app/bench/photos.h"
#include "base/log.h"
#include "base/progress.h"
#include "scene/axes.h"

namespace binosplat::app {

adagscale::CalibratedThreshold calibrated_threshold_of(const DrawingOptions& options) {
  if (!options.has_calibration()) return {};
  return {options.calibration, adagscale::load_calibration(options.calibration)};
}

render::FrameSettings settings_of(const adagscale::CalibratedThreshold& calibrated, const Shot& shot,
                                  const render::FrameSettings& asked, const ModelAxes& axes) {
  constexpr double same_focal = 0.1;  // relative; a smaller difference needs no warning
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

void measure_adagscale(const Options& o, const std::shared_ptr<render::GpuModel>& model, bool has_levels,
                       const CameraList& list, double near_plane, adagscale::CalibratedThreshold& calibrated,
                       render::FrameSettings& settings) {
  if (!measures_model(o.drawing)) return;
  const bool finds =
      finds_k(o.drawing) && adagscale::lacks_k(settings);  // the window may draw by another rule
  std::vector<adagscale::CalibrationView> views =
      photographed_views(training_choice(list, adagscale::default_views, {}), {}, o.camera.lens, list);
  if (finds && !settings.quality) settings.quality = o.drawing.quality;  // a K that was found has reset it
  if (finds && !has_levels) {
    remove_empty_views("--threshold adagscale", model->context(), model->model(), near_plane, views);
    Progress progress("finding K of AdaGScale", adagscale::search_steps * views.size(), "pictures");
    const adagscale::ThresholdCalibration found =
        adagscale::find_k(model, views, near_plane, settings, list.cameras,
                          [&](std::size_t pictures) { progress.update(pictures); });
    if (!o.drawing.calibration.empty()) save_json(o.drawing.calibration, json_of(found));
    log_info("AdaGScale: {}", adagscale::summary_of(found));
    calibrated = {o.drawing.calibration, found};
    settings.quality.reset();
    settings = calibrated.with_rule(settings);
    return;
  }
  std::vector<shared::View> eyes;
  for (const adagscale::CalibrationView& view : views)
    eyes.push_back(make_view(into_axes(view.camera, model->model().axes), near_plane));
  log_info("transmittance by depth: measuring {} view{} of {}", views.size(), views.size() == 1 ? "" : "s",
           list.source);
  render::Frame frame(model);
  settings.depth_table = adagscale::measure_depth_table(frame, eyes, {.frame = settings});
  if (!finds) return;
  settings.quality = settings.quality.value_or(static_cast<float>(adagscale::default_quality));
  log_info("the levels of detail follow the views, so frames measure the {:g} dB, not one K",
           *settings.quality);
}

}  // namespace binosplat::app
