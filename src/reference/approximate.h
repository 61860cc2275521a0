#pragma once
// The approximations of the squared rule beyond pairs (docs/method.md 5.2): it skips splats in blocks of a
// tile, and ends blocks that are dark.

#include "reference/project.h"
#include "shared/axes.h"
#include "shared/limits.h"

namespace binosplat::reference {

/// How the lists of tiles are blended.
struct Approximation {
  bool by_blocks = false;           // skips splats in blocks where their alpha is below Th
  double dark_transmittance = 0.0;  // a block ends once T is at most this in all its pixels; 0: never

  bool any() const { return by_blocks || dark_transmittance > 0.0; }
};

/// The approximation of a tile test and a rule of shared/axes.h; `tolerance` is as for threshold().
Approximation approximation_of(int tiles, int th, double tolerance);

/// Whether a splat is blended in the block of pixel (x, y). Tiles have `tile_size` px.
bool reaches_block(const Splat& splat, int x, int y, int tile_size);

}  // namespace binosplat::reference
