#pragma once
// The approximations of the rule `squared` in the blend: skipped blocks and dark blocks (docs/method.md 5.2).

#include "reference/project.h"

namespace binosplat::reference {

/// By default no approximation.
struct Approximation {
  bool by_blocks = false;           // skips splats in blocks where their alpha is below Th
  double dark_transmittance = 0.0;  // a block ends once T is at most this in each pixel; 0: never

  bool any() const { return by_blocks || dark_transmittance > 0.0; }
};

/// Returns the approximation for a tile test and a rule of shared/choices.h; `tolerance` is threshold()'s.
Approximation approximation_of(int tiles, Threshold threshold, double tolerance);

/// Whether a splat is blended in the block that contains pixel (x, y).
bool reaches_block(const Splat& splat, int x, int y);

}  // namespace binosplat::reference
