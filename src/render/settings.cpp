#include "render/settings.h"

#include <cmath>

#include "base/error.h"

namespace binosplat::render {

// Each condition also fails for values that are not finite.
void check(const FrameSettings& s, std::string_view prefix) {
  if (!(s.tolerance >= 0.0f) || !std::isfinite(s.tolerance))
    fail("{}tolerance {}: expected zero or more", prefix, s.tolerance);
  if (!(s.quality >= 0.0f) || !std::isfinite(s.quality))
    fail("{}quality {}: expected dB, above zero", prefix, s.quality);
  if (is_exact(s.th) && (s.tolerance > 0.0f || s.quality > 0.0f)) {
    fail("{0}{1} has no effect with the rule {2}, which is exact", prefix,
         s.tolerance > 0.0f ? "tolerance" : "quality", th_choices[s.th].name);
  }
  if (s.tolerance > 0.0f && s.quality > 0.0f)
    fail("{0}tolerance with {0}quality: both choose the tolerance: leave one of them out", prefix);
  if (s.probe_tiles < 1) fail("probe_tiles {}: expected at least 1", s.probe_tiles);
  if (s.measure_every < 1) fail("measure_every {}: expected at least 1 frame", s.measure_every);
}

FrameSettings exact_of(const FrameSettings& s) {
  return {.order = s.order, .projection = s.projection, .anchor_cull = s.anchor_cull};
}

void check_choice(const FrameSettings& s, std::string_view prefix) {
  check(s, prefix);
  if (s.quality > 0.0f && !(s.quality >= quality_least && s.quality <= quality_most))
    fail("{}quality {}: expected decibels from {} to {}", prefix, s.quality, quality_least, quality_most);
  if (!can_use(s.th, s.transmittance)) {
    fail("{0}transmittance has no effect with the rule {1}, which uses no transmittance bound", prefix,
         th_choices[s.th].name);
  }
}

}  // namespace binosplat::render
