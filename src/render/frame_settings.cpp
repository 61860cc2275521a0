#include "render/frame_settings.h"

#include <cmath>

#include "base/choices.h"
#include "base/error.h"

namespace binosplat::render {

namespace {

/// Throws Error if `value` is not one of the enumerators from 0 to `last`.
template <typename Enum>
void check_known(Enum value, Enum last, std::string_view prefix, const char* name) {
  const int number = static_cast<int>(value);
  if (number < 0 || number > static_cast<int>(last)) fail("{}{} {}: unknown value", prefix, name, number);
}

// Each condition also fails for values that are not finite.
void check_values(const FrameSettings& s, std::string_view prefix) {
  const glm::vec3 behind = s.background.value_or(glm::vec3(0.0f));
  for (int c = 0; c < 3; ++c) {
    if (!(behind[c] >= 0.0f && behind[c] <= 1.0f))
      fail("{}background ({}, {}, {}): expected numbers from 0 to 1", prefix, behind.r, behind.g, behind.b);
  }
  const double near = s.near_plane.value_or(near_default);
  if (!(near > 0.0) || !std::isfinite(static_cast<float>(near)))
    fail("{}near_plane {}: expected world units above zero", prefix, near);
  if (s.tolerance && (!(*s.tolerance >= 0.0f) || !std::isfinite(*s.tolerance)))
    fail("{}tolerance {}: expected zero or more", prefix, *s.tolerance);
  if (s.quality && !(*s.quality >= min_quality && *s.quality <= max_quality))
    fail("{}quality {}: expected decibels from {} to {}", prefix, *s.quality, min_quality, max_quality);
  check_known(s.threshold.value_or(Threshold::exact), Threshold::squared, prefix, "threshold");
  check_known(chosen_transmittance(s), Transmittance::last, prefix, "transmittance");
  check_known(s.order.value_or(Order::depth), Order::distance, prefix, "order");
  check_known(s.projection.value_or(Projection::affine), Projection::tangent, prefix, "projection");
  check_known(s.depth, DepthKind::median, prefix, "depth");
  if (s.probe_tiles < 1) fail("{}probe_tiles {}: expected at least 1", prefix, s.probe_tiles);
  if (s.measure_every < 1) fail("{}measure_every {}: expected at least 1 frame", prefix, s.measure_every);
}

}  // namespace

void check(const FrameSettings& s, std::string_view prefix, bool finds_tolerance) {
  check_values(s, prefix);
  if (s.quality && s.tolerance) {
    fail("{0}quality {1} with {0}tolerance {2}: both choose the tolerance: leave one of them out", prefix,
         *s.quality, *s.tolerance);
  }
  if (s.quality && s.foveation)
    fail("{0}quality with {0}foveation: it is for whole pictures: give {0}tolerance", prefix);
  if (finds_tolerance && !s.threshold) return;  // the calibration names the rule
  const Threshold threshold = chosen_threshold(s);
  if (is_exact(threshold) && (s.quality || s.tolerance)) {
    fail("{0}{1} has no effect with an exact {0}threshold: leave one of them out", prefix,
         s.quality ? "quality" : "tolerance");
  }
  if (!can_use(threshold, chosen_transmittance(s))) {
    fail("{0}transmittance {1} has no effect on exact pictures: give {0}quality or {0}tolerance, too", prefix,
         name_of(*s.transmittance));
  }
  if (!is_exact(threshold) && !s.quality && !s.tolerance && !finds_tolerance) {
    fail("{0}threshold {1} needs {0}tolerance, {0}quality or a calibration, which set the accepted loss",
         prefix, name_of(threshold));
  }
}

FrameSettings exact_of(const FrameSettings& s) {
  FrameSettings exact{{.order = s.order, .projection = s.projection, .depth = s.depth}};
  exact.anchor_cull = s.anchor_cull;
  return exact;
}

}  // namespace binosplat::render
