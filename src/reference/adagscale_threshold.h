#pragma once
// Th: a Gaussian is paired with the tiles in which its alpha reaches Th (docs/method.md 5). With the rule
// `squared`, the blend also skips it in blocks in which alpha is below Th (approximate.h). Apart from this,
// the blend uses tau and the true alpha.

#include <binosplat/settings.h>

#include <span>
#include <vector>

#include "reference/project.h"
#include "shared/choices.h"

namespace binosplat::reference {

/// Returns Th of a splat by a `rule`; at least tau. adagscale_threshold.cpp has each rule's equation and the
/// unit of `tolerance`. `bound` is T_upper: 1, or a transmittance, measured (adagscale_transmittance.h) or of
/// the table by depth. Throws Error unless `bound` is above 0: 0 would drop visible Gaussians.
double threshold(Threshold rule, double tolerance, const Splat& splat, double bound);

/// Sets Th of every splat. `bounds` has T_upper of each Gaussian; empty: 1 for all. With rules other than
/// Threshold::exact, clears `drawn` of splats with Th > sigma, whatever the tile test.
void set_thresholds(std::vector<Splat>& splats, Threshold rule, double tolerance,
                    std::span<const double> bounds = {});

}  // namespace binosplat::reference
