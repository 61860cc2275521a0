#pragma once
// The properties of each threshold rule.

#include <binosplat/settings.h>

#include <iterator>

#include "shared/choices.h"

namespace binosplat::render {

/// A rule of threshold_choices (shared/choices.h), which also has the unit of the rule's tolerance.
/// shaders/threshold/NAME.glsl computes its Th, and reference/adagscale_threshold.cpp the same in float64.
struct ThresholdRule {
  bool exact = false;       // drops only invisible pairs, and has no tolerance
  bool uses_bound = false;  // uses T_upper
  /// The first tolerance that --quality measures. It gave 40 dB or slightly more on every shared scene at a
  /// focal length of 700 px (docs/method.md 8).
  double starting_tolerance = 0.0;
  double slope = 0.0;  // the mean squared error grows about as tolerance^slope
};

inline constexpr ThresholdRule threshold_rules[] = {
    {.exact = true},
    {.uses_bound = true, .starting_tolerance = 1.0, .slope = 2.0},
    {.uses_bound = true, .starting_tolerance = 0.1, .slope = 1.5},
};
static_assert(std::size(threshold_rules) == std::size(threshold_choices));

constexpr const ThresholdRule& rule_of(Threshold threshold) {
  return threshold_rules[static_cast<int>(threshold)];
}

constexpr bool is_exact(Threshold threshold) { return rule_of(threshold).exact; }

/// Whether a tile test finds every visible pair.
constexpr bool has_every_pair(int tiles) {
  return tiles == TILES_ELLIPSE || tiles == TILES_SNUG || tiles == TILES_ALL;
}

/// The source of T_upper that goes with a rule: AdaGScale's is the table by depth.
constexpr Transmittance usual_source(Threshold threshold) {
  return threshold == Threshold::adagscale ? Transmittance::depth : Transmittance::one;
}

/// Whether a rule can use these bounds.
constexpr bool can_use(Threshold threshold, Transmittance transmittance) {
  return transmittance == Transmittance::one || rule_of(threshold).uses_bound;
}

}  // namespace binosplat::render
