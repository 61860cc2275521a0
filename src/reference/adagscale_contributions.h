#pragma once
// The contributions of fragments, and pictures without the lowest ones (figures 4 and 5 of AdaGScale). A
// fragment is a Gaussian in a pixel that blends it, or with Counted::evaluated, in a pixel that evaluates it.

#include <cstdint>
#include <span>
#include <vector>

#include "base/image.h"
#include "reference/project.h"
#include "reference/tiles.h"

namespace binosplat::reference {

struct Skipped {
  double share = 0.0;           // the skipped share of the fragments; at most the requested share
  std::uint64_t fragments = 0;  // number of all fragments
  Picture picture;
};

/// The fragments whose pixel lies within a range of distances from the splat's middle.
struct DistanceBin {
  double from = 0.0, to = 0.0;  // px
  std::uint64_t fragments = 0;
  double sum = 0.0;      // of the fragments' contributions, alpha T
  double largest = 0.0;  // the largest contribution, alpha T
};

/// Adds the bins `more` to the bins `sums` of the same distances.
void add(std::vector<DistanceBin>& sums, const std::vector<DistanceBin>& more);

/// Returns the fragments of a view by distance: a bin below 1 px, then two bins per octave. The last bin
/// includes all distances beyond 2,048 px. The result does not depend on the number of threads.
std::vector<DistanceBin> contributions_by_distance(const std::vector<Splat>& splats, const TileLists& lists,
                                                   const shared::View& view);

/// Which fragments a share is of: those that pixels blend, or all entries of their tiles' lists up to their
/// ends. An entry whose alpha is below tau contributes nothing.
enum class Counted { blended, evaluated };

/// Returns a picture for each of `shares` (0 to 1), without this share of the fragments: the share with the
/// lowest scores. The score is alpha times the Gaussian's element of `bounds`: max(T), T_upper of its depth,
/// or 1; if `bounds` is empty, alpha T, the true contribution. Fragments whose scores differ by less than 1 %
/// are skipped together. Behind skipped fragments T is larger. The result does not depend on threads.
std::vector<Skipped> skip_lowest(const std::vector<Splat>& splats, const TileLists& lists,
                                 const shared::View& view, std::span<const double> bounds,
                                 std::span<const double> shares, Counted counted = Counted::blended);

}  // namespace binosplat::reference
