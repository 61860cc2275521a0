#pragma once
// Contributions of single fragments, and the loss of a picture without the lowest ones (AdaGScale, figures 4
// and 5). A fragment is a Gaussian that a pixel blends.

#include <cstdint>
#include <span>
#include <vector>

#include "base/image.h"
#include "reference/project.h"
#include "reference/tiles.h"

namespace binosplat::reference {

struct Skipped {
  double share = 0.0;  // skipped share of the fragments; at most the requested one
  Picture picture;
};

/// The fragments within a range of distances between pixel and splat's middle.
struct DistanceBin {
  double from = 0.0, to = 0.0;  // px
  std::uint64_t fragments = 0;
  double sum = 0.0;      // of their contributions alpha T
  double largest = 0.0;  // alpha T
};

/// Adds bins of other fragments to equally many bins.
void add(std::vector<DistanceBin>& sums, const std::vector<DistanceBin>& more);

/// The fragments of a view by distance: below 1 px, then two bins an octave. The last bin includes those
/// beyond 2,048 px. The result does not depend on the number of threads.
std::vector<DistanceBin> contributions_by_distance(const std::vector<Splat>& splats, const TileLists& lists,
                                                   const shared::View& view);

/// The pictures of a view without its lowest fragments, one for each of `shares` (0 to 1). The score of a
/// fragment is alpha times the element of `bounds` for its Gaussian: max(T), T_upper of its depth, or 1.
/// Empty `bounds` score by alpha T, the true contribution. Fragments of equal score (to 1 %) are skipped
/// together. The others are blended as usual, so those behind skipped ones receive more transmittance. The
/// result does not depend on the number of threads.
std::vector<Skipped> skip_lowest(const std::vector<Splat>& splats, const TileLists& lists,
                                 const shared::View& view, std::span<const double> bounds,
                                 std::span<const double> shares);

}  // namespace binosplat::reference
