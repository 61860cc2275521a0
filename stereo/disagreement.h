#pragma once
// Binocular disagreement (docs/method.md 6): the part of an approximation's error that the two eyes do not
// share; and the error of its disparities. A shared error changes the picture. An error in only one eye
// causes binocular rivalry, which looks like shimmer in depth.

#include <array>
#include <span>

#include "base/image.h"
#include "shared/types.h"

namespace binosplat::stereo {

struct Disagreement {
  double db = 0.0;       // -10 log10 of the mean squared difference; infinite if it is 0; higher is better
  double counted = 0.0;  // share of the left eye's pixels that both eyes see; if it is 0, db is NaN
  Image picture;         // |eL(p) - eR(p')| of RGB at the left pixel p; 0 if p does not count
  Image right;           // eR(p') at the left pixel p; eL(p) if p does not count
  /// px: |p'' - p'| at the left pixel p, where p'' is as p', but at the approximate depth of p; -1 if p does
  /// not count or has no approximate depth.
  Image disparity;
};

/// The error e of an eye is the approximate minus the exact colour, over black and not clamped. `db` has the
/// mean of (eL(p) - eR(p'))^2 over channels and over the left eye's pixels p. p' is the position in the right
/// picture of the scene point that p shows at its exact depth; eR is read bilinearly. A pixel p counts if it
/// has a depth, p' is inside the right picture, and the right eye sees the point: the right exact depth at
/// the pixel nearest to p' differs by at most 1 %. The left eye comes first. Throws Error unless all pictures
/// have their view's size.
Disagreement disagreement(const std::array<shared::View, 2>& views, std::span<const Picture> exact,
                          std::span<const Picture> approximate);

}  // namespace binosplat::stereo
