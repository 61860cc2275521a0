#pragma once
// What is particular to each threshold rule.

#include <iterator>

#include "shared/axes.h"

namespace binosplat::render {

/// A rule of th_choices (shared/axes.h), which has the unit of its tolerance; shaders/threshold/NAME.glsl
/// computes its Th, reference/threshold.cpp the same in float64.
struct ThresholdRule {
  bool exact = false;       // leaves out only what leaves no mark: it has no tolerance
  bool uses_bound = false;  // T_upper matters to it
  /// Where a search for a tolerance begins: gave 40 dB or a little more on every shared scene at a focal
  /// length of 700 px (docs/method.md 8).
  double careful_tolerance = 0.0;
  double slope = 0.0;  // a frame's mean squared error grows about as tolerance^slope
};

/// By TH_ of shared/axes.h.
inline constexpr ThresholdRule threshold_rules[] = {
    {.exact = true},
    {.uses_bound = true, .careful_tolerance = 1.0, .slope = 2.0},
    {.uses_bound = true, .careful_tolerance = 0.1, .slope = 1.5},
};
static_assert(std::size(threshold_rules) == std::size(th_choices));

constexpr bool is_exact(int th) { return threshold_rules[th].exact; }

/// Whether a tile test makes every pair that can be seen.
constexpr bool has_every_pair(int tiles) {
  return tiles == TILES_ELLIPSE || tiles == TILES_SNUG || tiles == TILES_ALL;
}

/// Whether a rule can use a transmittance bound from there.
constexpr bool takes(int th, int transmittance) {
  return transmittance == TRANSMITTANCE_ONE || threshold_rules[th].uses_bound;
}

}  // namespace binosplat::render
