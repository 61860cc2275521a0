#pragma once
// Th: a Gaussian with a smaller alpha is not paired with a tile (docs/method.md 5). With the squared rule the
// blend also skips it in blocks where alpha is below Th (approximate.h). Otherwise the blend uses tau and the
// true alpha.

#include <span>
#include <vector>

#include "reference/project.h"
#include "shared/axes.h"

namespace binosplat::reference {

/// Th of a splat by a rule of shared/axes.h, at least tau. threshold.cpp gives each rule's equation and the
/// unit of `tolerance`. `bound` is T_upper: 1, or a measured transmittance (transmittance.h) with a floor.
/// Throws Error if it is not above 0, which would cause holes.
double threshold(int th, double tolerance, const Splat& splat, double bound);

/// Sets Th of every splat. Unless the rule is TH_TAU, splats with Th > sigma are no longer drawn, whatever
/// the tile test. `bounds` has an element per Gaussian; empty: 1 for all.
void set_thresholds(std::vector<Splat>& splats, int th, double tolerance,
                    std::span<const double> bounds = {});

}  // namespace binosplat::reference
