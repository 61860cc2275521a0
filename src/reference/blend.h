#pragma once
// The blend (docs/method.md 3): each pixel walks its tile's list front to back.

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "reference/project.h"
#include "reference/tiles.h"

namespace binosplat::reference {

/// Wrong on purpose, for tests that must notice. What can be planted in the data (a negated SH coefficient, a
/// shifted mean) needs no switch.
struct Faults {
  bool stop_late = false;  // the Gaussian that crosses TRANSMITTANCE_MIN is added before the pixel stops
};

/// Alphas of a blend, summed over the pixels (docs/method.md 8 has them per pixel). Evaluated counts what
/// a GPU does: the pixels of a tile walk its list together until the last of them has ended.
struct BlendCounts {
  std::uint64_t evaluated = 0;
  std::uint64_t visible = 0;  // blended
};

/// The picture of a view, computed in float64 and rounded to float once, at the end. `counts`, where given,
/// is set. Faults and counts are of blends that are exact.
Picture blend(const std::vector<Splat>& splats, const TileLists& lists, const shared::View& view,
              Faults faults = {}, BlendCounts* counts = nullptr);

}  // namespace binosplat::reference
