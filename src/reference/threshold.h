#pragma once
// Th, the alpha below which a Gaussian makes no pair with a tile (docs/method.md 5). By the squared rule the
// blend leaves it out of blocks, too, where its alpha stays below (approximate.h); else it uses tau and the
// true alpha.

#include <span>
#include <vector>

#include "reference/project.h"
#include "shared/axes.h"

namespace binosplat::reference {

/// Th of a splat by a rule of shared/axes.h, never below tau; its case in threshold.cpp says by which
/// equation, and what `tolerance` is. `bound` is T_upper, the transmittance bound of the splat: 1, or
/// a measured value (transmittance.h) with a floor. Throws Error where it is not above 0, which would leave a
/// hole in the picture.
double threshold(int th, double tolerance, const Splat& splat, double bound);

/// Sets Th of every splat. By all rules but TH_TAU, what has Th > sigma is out of this view: it is
/// not drawn any more, whatever the tile test. `bounds` are by Gaussian; empty: 1 for all.
void set_thresholds(std::vector<Splat>& splats, int th, double tolerance,
                    std::span<const double> bounds = {});

}  // namespace binosplat::reference
