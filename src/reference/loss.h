#pragma once
// What the squared rule leaves out beyond pairs (docs/method.md 5.2): blocks of a tile, and the last of a
// pixel's light.

#include "reference/project.h"
#include "shared/axes.h"
#include "shared/limits.h"

namespace binosplat::reference {

/// How a tile's list is blended.
struct Loss {
  int tile_size = 0;        // px; 0: without a loss
  double last_light = 0.0;  // T at most of all pixels of a block that ends
};

/// By a tile test and a rule of shared/axes.h; `tolerance` as of threshold().
Loss loss_of(int tiles, int th, double tolerance, int tile_size = TILE_SIZE_DEFAULT);

/// Whether a splat is blended in the block that holds pixel (x, y).
bool reaches_block(const Splat& splat, int x, int y, const Loss& loss);

}  // namespace binosplat::reference
