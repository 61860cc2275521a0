#pragma once
// What is particular to each threshold rule, and which settings of a frame go together.

#include <iterator>
#include <string_view>

#include "render/settings.h"

namespace binosplat::render {

/// A rule of th_choices (shared/axes.h): shaders/threshold/NAME.glsl computes its Th, reference/threshold.cpp
/// the same in float64.
struct ThresholdRule {
  bool exact = false;          // leaves out only what leaves no mark: it has no loss
  bool goes_by_light = false;  // T_upper matters to it
  const char* unit = "";       // of its loss
  /// Where a search for a loss begins: gave 40 dB or a little more on every shared scene at a focal length of
  /// 700 px (METHOD 8).
  double careful_loss = 0.0;
  double slope = 0.0;  // a frame's mean squared error grows about as loss^slope
};

/// By TH_ of shared/axes.h.
inline constexpr ThresholdRule threshold_rules[] = {
    {.exact = true},
    {.goes_by_light = true, .unit = "alpha * px^2", .careful_loss = 1.0, .slope = 2.0},
    {.goes_by_light = true, .unit = "px * squared colour", .careful_loss = 0.1, .slope = 1.5},
};
static_assert(std::size(threshold_rules) == std::size(th_choices));

constexpr bool is_exact(int th) { return threshold_rules[th].exact; }

/// Whether a rule can go by light from there.
constexpr bool takes(int th, int transmittance) {
  return transmittance == TRANSMITTANCE_ONE || threshold_rules[th].goes_by_light;
}

/// Throws Error for values that no frame has and for settings that contradict each other: an exact rule with
/// a loss or a quality, a loss with a quality, weights or the reference with what earlier frames tell.
/// `prefix` goes before the names of settings in the text: "--" where they were given as options.
void check(const FrameSettings& settings, std::string_view prefix = "");

/// The same for what somebody chose to draw by, where all must have an effect: no transmittance with a rule
/// that goes by no light. (A frame may measure light by any rule, as measure_depth_table does.)
void check_choice(const FrameSettings& settings, std::string_view prefix = "");

}  // namespace binosplat::render
