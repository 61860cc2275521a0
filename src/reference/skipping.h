#pragma once
// What single fragments contribute, and what a picture loses when the blend leaves out what it takes for the
// least (AdaGScale, figures 4 and 5). A fragment is a Gaussian that a pixel blends.

#include <cstdint>
#include <span>
#include <vector>

#include "base/image.h"
#include "reference/project.h"
#include "reference/tiles.h"

namespace binosplat::reference {

struct Skipped {
  double share = 0.0;  // of the fragments, that was skipped: at most as much as was asked for
  Picture picture;
};

/// The fragments whose pixel lies so far from the middle of the Gaussian's splat.
struct DistanceBin {
  double from = 0.0, to = 0.0;  // px
  std::uint64_t fragments = 0;
  double sum = 0.0;      // of their contributions alpha T
  double largest = 0.0;  // alpha T
};

/// Adds bins of other fragments to as many.
void add(std::vector<DistanceBin>& sums, const std::vector<DistanceBin>& more);

/// The fragments of a view by distance: below 1 px, then two bins an octave; those beyond 2,048 px lie in the
/// last bin. The same bits with any number of threads.
std::vector<DistanceBin> contributions_by_distance(const std::vector<Splat>& splats, const TileLists& lists,
                                                   const shared::View& view);

/// The pictures of a view without the lowest of its fragments: for every one of `shares` (0 to 1) the one
/// that skips so many. Skipped is by alpha times `bounds`, the largest T that the Gaussian is thought to meet
/// (by Gaussian: max(T), T_upper of its depth, or 1); where `bounds` is empty by alpha T, what the fragment
/// truly contributes. Fragments of one score, to 1 %, are skipped together. What is left is blended as ever:
/// more transmittance is left for what lay behind. The same bits with any number of threads.
std::vector<Skipped> skip_lowest(const std::vector<Splat>& splats, const TileLists& lists,
                                 const shared::View& view, std::span<const double> bounds,
                                 std::span<const double> shares);

}  // namespace binosplat::reference
