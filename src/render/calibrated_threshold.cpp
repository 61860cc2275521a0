#include "render/calibrated_threshold.h"

#include <fmt/format.h>

#include <cmath>

#include "base/choices.h"
#include "base/error.h"
#include "render/frame_plan.h"
#include "scene/axes.h"

namespace binosplat::render {

namespace {

constexpr double tolerance_power = 1.25;  // exponent of the focal length

const CalibrationEntry* entry_for(const ThresholdCalibration& calibration, const FrameSettings& requested) {
  const Threshold threshold = chosen_threshold(requested, true);
  for (const CalibrationEntry& entry : calibration.entries)
    if (entry.threshold == threshold && entry.transmittance == requested.transmittance) return &entry;
  return nullptr;
}

std::string text_of(const Perspective& perspective, double kernel_px2, bool antialiased, double near_plane) {
  return fmt::format(
      "order {}, projection {}, a low-pass of {:.4g} px^2 {} anti-aliasing and a near plane of {:.4g}",
      name_of(perspective.order), name_of(perspective.projection), kernel_px2,
      antialiased ? "with" : "without", near_plane);
}

}  // namespace

bool CalibratedThreshold::has_entry(const FrameSettings& requested) const {
  return calibration_ && entry_for(*calibration_, requested) != nullptr;
}

void CalibratedThreshold::check(const FrameSettings& requested) const {
  if (!calibration_ || has_entry(requested)) return;
  fail("calibration {} has no entry for threshold {} with transmittance {}", name_,
       name_of(chosen_threshold(requested, true)), name_of(requested.transmittance));
}

void CalibratedThreshold::check_drawing(const FrameSettings& requested, const Model& model,
                                        double near_plane) const {
  if (!calibration_) return;
  const ThresholdCalibration& c = *calibration_;
  const std::string calibrated = text_of(c.perspective, c.kernel_px2, c.antialiased, c.near_plane);
  const std::string drawn =
      text_of(perspective_of(requested, model), model.kernel_px2, model.antialiased, near_plane);
  if (calibrated == drawn) return;
  fail("calibration {} is for {}, but the frame has {}: calibrate with these settings", name_, calibrated,
       drawn);
}

void CalibratedThreshold::check_model(const Model& model) const {
  if (!calibration_ || is_of(*calibration_, model)) return;
  fail("calibration {} is of another model ({}, {} Gaussians): calibrate this one, or draw without", name_,
       calibration_->model_name, calibration_->gaussians);
}

bool CalibratedThreshold::covers(const shared::View& view, const ModelAxes& axes) const {
  if (!calibration_) return true;
  const glm::dvec3 eye = glm::dvec3(view.anchor) + glm::dvec3(view.eye);
  return binosplat::covers(*calibration_, into_world(eye, axes));
}

FrameSettings CalibratedThreshold::settings(FrameSettings requested, const shared::View& view,
                                            const ModelAxes& axes) const {
  if (!calibration_) return requested;
  requested.threshold = chosen_threshold(requested, true);
  if (is_exact(*requested.threshold)) return requested;
  if (!covers(view, axes)) {
    requested.threshold = Threshold::exact;
    requested.tolerance.reset();
    requested.quality.reset();
    requested.transmittance = Transmittance::one;
    return requested;
  }
  requested.depth_table = calibration_->depth_table;
  if (requested.tolerance || requested.quality) return requested;
  check(requested);
  const double focal = static_cast<double>(view.lens.x) / calibration_->focal;
  requested.tolerance =
      static_cast<float>(entry_for(*calibration_, requested)->tolerance * std::pow(focal, tolerance_power));
  return requested;
}

}  // namespace binosplat::render
