#include "app/calibrated.h"

#include <cmath>

#include "base/error.h"
#include "base/log.h"
#include "render/frame_plan.h"

namespace binosplat::app {

namespace {

constexpr double same_focal = 0.05;  // share: nearer than this the tolerance needs no scaling to speak of

render::FrameSettings without_calibration(render::FrameSettings settings) {
  settings.th = TH_TAU;
  settings.tolerance = 0.0f;
  settings.transmittance = TRANSMITTANCE_ONE;
  return settings;
}

}  // namespace

CalibratedSettings::CalibratedSettings(const DrawingOptions& options)
    : file_(options.calibration), own_tolerance_(options.tolerance.has_value()) {
  if (file_.empty()) return;
  calibration_ = lab::load_calibration(file_);
  const render::FrameSettings asked = settings_of(options);
  if (!lab::calibrated(*calibration_, asked, calibration_->focal))
    fail("--calibration {} has no entry for --th {} --transmittance {}", file_, th_choices[asked.th].name,
         transmittance_choices[asked.transmittance].name);
}

void CalibratedSettings::check_model(const Model& model, const render::FrameSettings& settings) {
  const Perspective drawn = render::perspective_of(settings, model);
  if (calibration_ && calibration_->perspective != drawn) {
    const auto text = [](const Perspective& p) {
      return fmt::format("--order {} --projection {}", order_choices[p.order].name,
                         projection_choices[p.projection].name);
    };
    fail("--calibration {} is for {}, and this is drawn with {}: calibrate with these", file_,
         text(calibration_->perspective), text(drawn));
  }
  other_model_ = calibration_ && !lab::is_of(*calibration_, model);
  if (other_model_)
    log_warning("--calibration {} is of another model ({}, {} Gaussians): drawing exactly", file_,
                calibration_->model_name, calibration_->gaussians);
}

render::FrameSettings CalibratedSettings::of(const Shot& shot, render::FrameSettings settings) const {
  if (!calibration_) return settings;
  if (other_model_) return without_calibration(settings);
  const Camera& camera = shot.eyes.front().camera;
  if (!lab::covers(*calibration_, camera.position)) {
    log_warning("{} is far from the calibrated views: drawing it exactly", shot.name);
    return without_calibration(settings);
  }
  if (own_tolerance_) {
    settings.depth_table = calibration_->depth_table;
    return settings;
  }
  if (std::abs(camera.fx / calibration_->focal - 1.0) > same_focal)
    log_warning(
        "{} has a focal length of {:.0f} px and was calibrated at {:.0f}: the tolerance is scaled, the dB "
        "are "
        "rough",
        shot.name, camera.fx, calibration_->focal);
  return *lab::calibrated(*calibration_, settings, camera.fx);
}

}  // namespace binosplat::app
