#include <binosplat/renderer.h>

#include "base/error.h"
#include "formats/calibration_file.h"
#include "library/numbers.h"
#include "library/settings.h"
#include "library/views.h"
#include "render/threshold_policy.h"

namespace binosplat {

struct Calibration::Impl {
  std::shared_ptr<const Model> model;
  render::ThresholdPolicy policy;
};

Calibration::Calibration(const std::filesystem::path& path, const SplatModel& model) {
  if (model.model_ == nullptr) fail("model was moved from: expected a valid SplatModel");
  impl_ = std::make_shared<const Impl>(
      Impl{model.model_, render::ThresholdPolicy(path.string(), load_calibration(path))});
  impl_->policy.check_model(*model.model_);
}

Settings Calibration::settings(std::span<const View> views, const Placement& placement,
                               const Settings& asked) const {
  if (impl_ == nullptr) fail("this Calibration was moved from: expected a valid one");
  if (views.empty()) fail("no views: expected the views of a frame");
  library::check_numbers(views, placement);
  library::check_numbers(asked);
  Settings found = asked;
  found.near_plane = asked.near_plane.value_or(impl_->policy.calibration().near_plane);
  render::FrameSettings frame{.th = library::rule_of(asked, true),
                              .transmittance = static_cast<int>(asked.transmittance),
                              .tolerance = asked.tolerance.value_or(0.0f),
                              .quality = asked.quality.value_or(0.0f)};
  if (asked.order) frame.order = static_cast<int>(*asked.order);
  if (asked.projection) frame.projection = static_cast<int>(*asked.projection);
  if (!asked.tolerance && !asked.quality) impl_->policy.check(frame);
  impl_->policy.check_drawing(frame, *impl_->model, *found.near_plane);
  const auto head = library::views_of(views, placement, impl_->model->axes.origin, found, *impl_->model);
  frame = impl_->policy.settings(std::move(frame), head.views.front(), impl_->model->axes);
  found.transmittance = static_cast<Transmittance>(frame.transmittance);
  found.depth_table = std::move(frame.depth_table);
  found.threshold = static_cast<Threshold>(frame.th);
  found.tolerance.reset();
  if (render::is_exact(frame.th)) {
    found.quality.reset();
  } else if (!asked.quality) {
    found.tolerance = frame.tolerance;
  }
  return found;
}

}  // namespace binosplat
