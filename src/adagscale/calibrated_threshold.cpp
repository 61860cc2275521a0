#include "adagscale/calibrated_threshold.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/choices.h"
#include "base/error.h"
#include "render/frame_plan.h"
#include "scene/axes.h"

namespace binosplat::adagscale {

namespace {

constexpr double tolerance_power = 1.25;  // exponent of the focal length

const CalibrationEntry* entry_for(const ThresholdCalibration& calibration, const FrameSettings& requested) {
  const auto is_named = [&](const CalibrationEntry& entry) {
    return requested.threshold.value_or(entry.threshold) == entry.threshold &&
           requested.transmittance.value_or(entry.transmittance) == entry.transmittance;
  };
  const auto found = std::ranges::find_if(calibration.entries, is_named);
  return found == calibration.entries.end() ? nullptr : &*found;
}

bool needs_entry(const FrameSettings& s) {
  return !s.tolerance && !s.quality && s.threshold != Threshold::exact;
}

std::string text_of(const Perspective& perspective, double kernel_px2, bool antialiased, double near_plane) {
  return fmt::format(
      "order {}, projection {}, a low-pass of {:.4g} px^2 {} anti-aliasing and a near plane of {:.4g}",
      name_of(perspective.order), name_of(perspective.projection), kernel_px2,
      antialiased ? "with" : "without", near_plane);
}

}  // namespace

bool lacks_k(const Settings& settings) {
  return settings.threshold == Threshold::adagscale && !settings.tolerance;
}

bool CalibratedThreshold::has_entry(const FrameSettings& requested) const {
  return calibration_ && entry_for(*calibration_, requested) != nullptr;
}

FrameSettings CalibratedThreshold::with_rule(FrameSettings requested) const {
  if (!calibration_ || !needs_entry(requested)) return requested;
  const CalibrationEntry* const entry = entry_for(*calibration_, requested);
  if (entry == nullptr) {
    const std::string source = requested.transmittance
                                   ? fmt::format(" with transmittance {}", name_of(*requested.transmittance))
                                   : "";
    fail("calibration {} has no entry for {}{}", name_,
         requested.threshold ? fmt::format("threshold {}", name_of(*requested.threshold)) : "any threshold",
         source);
  }
  requested.threshold = entry->threshold;
  requested.transmittance = entry->transmittance;
  return requested;
}

void CalibratedThreshold::check_drawing(const FrameSettings& requested, const Model& model,
                                        double near_plane) const {
  if (!calibration_) return;
  const ThresholdCalibration& c = *calibration_;
  const std::string calibrated = text_of(c.perspective, c.kernel_px2, c.antialiased, c.near_plane);
  const std::string drawn =
      text_of(render::perspective_of(requested, model), model.kernel_px2, model.antialiased, near_plane);
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
  return adagscale::covers(*calibration_, into_world(eye, axes));
}

FrameSettings CalibratedThreshold::settings(const FrameSettings& requested, const shared::View& view,
                                            const ModelAxes& axes) const {
  if (!calibration_) return requested;
  FrameSettings found = with_rule(requested);
  if (render::is_exact(render::chosen_threshold(found))) return found;
  if (!covers(view, axes)) {
    found.threshold = Threshold::exact;
    found.tolerance.reset();
    found.quality.reset();
    found.transmittance = Transmittance::one;
    return found;
  }
  found.depth_table = calibration_->depth_table;
  if (!needs_entry(requested)) return found;
  const double focal = static_cast<double>(view.lens.x) / calibration_->focal;
  found.tolerance =
      static_cast<float>(entry_for(*calibration_, found)->tolerance * std::pow(focal, tolerance_power));
  return found;
}

}  // namespace binosplat::adagscale
