#pragma once
// What a picture loses when the blend leaves out what it takes for the least (AdaGScale, figures 4 and 5).

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

/// The pictures of a view without the lowest of its fragments, a Gaussian blended in a pixel each: for every
/// one of `shares` (0 to 1) the one that skips so many. Skipped is by alpha times `bounds`, the
/// largest T that the Gaussian is thought to meet (by Gaussian: max(T), T_upper of its depth, or 1); where
/// `bounds` is empty by alpha T, what the fragment truly contributes. Fragments of one score, to 1 %, are
/// skipped together. What is left is blended as ever: more transmittance is left for what lay behind. The
/// same bits with any number of threads.
std::vector<Skipped> skip_lowest(const std::vector<Splat>& splats, const TileLists& lists,
                                 const shared::View& view, std::span<const double> bounds,
                                 std::span<const double> shares);

}  // namespace binosplat::reference
