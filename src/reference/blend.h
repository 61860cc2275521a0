#pragma once
// The blend (docs/method.md 3): each pixel walks its tile's list front to back.

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "reference/project.h"
#include "reference/tiles.h"

namespace binosplat::reference {

/// Planted faults for tests. Faults in data (a negated SH coefficient, a shifted mean) need no switch.
struct Faults {
  bool stop_late = false;  // adds the Gaussian that crosses TRANSMITTANCE_MIN
};

/// Alphas of a blend, summed over pixels (docs/method.md 8 gives them per pixel). `evaluated` counts a GPU's
/// work: all pixels of a tile walk its list until the last of them ends.
struct BlendCounts {
  std::uint64_t evaluated = 0;
  std::uint64_t visible = 0;  // blended
};

/// The picture of a view, computed in float64 and rounded to float once. Sets `counts` if given. Faults and
/// counts require an exact blend.
Picture blend(const std::vector<Splat>& splats, const TileLists& lists, const shared::View& view,
              Faults faults = {}, BlendCounts* counts = nullptr);

}  // namespace binosplat::reference
