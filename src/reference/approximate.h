#pragma once
// What the squared rule leaves out beyond pairs (docs/method.md 5.2): blocks of a tile, and what lies
// behind dark ones.

#include "reference/project.h"
#include "shared/axes.h"
#include "shared/limits.h"

namespace binosplat::reference {

/// How a tile's list is blended.
struct Approximation {
  bool by_blocks = false;  // a block only with what reaches it at Th
  double dark_transmittance =
      0.0;  // T at most of all pixels of a block that ends before its list; 0: none does

  bool any() const { return by_blocks || dark_transmittance > 0.0; }
};

/// By a tile test and a rule of shared/axes.h; `tolerance` as of threshold().
Approximation approximation_of(int tiles, int th, double tolerance);

/// Whether a splat is blended in the block that holds pixel (x, y), with tiles of `tile_size` px.
bool reaches_block(const Splat& splat, int x, int y, int tile_size);

}  // namespace binosplat::reference
