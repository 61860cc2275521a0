#pragma once
// The blend (docs/method.md 3): each pixel walks its tile's list front to back.

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "reference/project.h"
#include "reference/tiles.h"

namespace binosplat::reference {

/// Faults that tests inject into the blend. Faults in data, such as a negated SH coefficient or a shifted
/// mean, need no switch.
struct Faults {
  bool stop_late = false;  // also blends the Gaussian before which a pixel must stop
};

/// Numbers of alphas, summed over pixels. `evaluated` counts as a GPU works: all pixels of a tile walk its
/// list until the last pixel ends.
struct BlendCounts {
  std::uint64_t evaluated = 0;
  std::uint64_t visible = 0;  // blended
};

/// Returns the picture of a view, computed in float64 and rounded to float once. Sets `counts` if given.
/// Throws Error for faults or counts with an approximate blend.
Picture blend(const std::vector<Splat>& splats, const TileLists& lists, const shared::View& view,
              Faults faults = {}, BlendCounts* counts = nullptr);

}  // namespace binosplat::reference
