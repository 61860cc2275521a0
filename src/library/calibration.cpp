#include <binosplat/renderer.h>

#include "adagscale/calibrated_threshold.h"
#include "adagscale/calibration_file.h"
#include "base/error.h"
#include "library/conversions.h"
#include "library/numbers.h"
#include "library/views.h"

namespace binosplat {

struct Calibration::Impl {
  std::shared_ptr<const Model> model;
  adagscale::CalibratedThreshold calibrated;
};

Calibration::Calibration(const std::filesystem::path& path, const SplatModel& model) {
  if (model.model_ == nullptr) fail("model was moved from: expected a valid SplatModel");
  impl_ = std::make_shared<const Impl>(
      Impl{model.model_, adagscale::CalibratedThreshold(path.string(), adagscale::load_calibration(path))});
  impl_->calibrated.check_model(*model.model_);
}

Settings Calibration::settings(std::span<const View> views, const Placement& placement,
                               const Settings& asked) const {
  if (impl_ == nullptr) fail("this Calibration was moved from: expected a valid one");
  if (views.empty()) fail("no views: expected the views of a frame");
  library::check_numbers(views, placement);
  render::FrameSettings frame{asked};
  render::check(frame, library::prefix, true);
  frame = impl_->calibrated.with_rule(frame);
  frame.near_plane = asked.near_plane.value_or(impl_->calibrated.calibration().near_plane);
  impl_->calibrated.check_drawing(frame, *impl_->model, *frame.near_plane);
  const auto drawn = library::views_of(views, placement, impl_->model->axes.origin, frame, *impl_->model);
  return impl_->calibrated.settings(std::move(frame), drawn.front(), impl_->model->axes);
}

}  // namespace binosplat
