#pragma once
// Binocular disagreement (docs/method.md 6): the part of an approximation's error that the two eyes do not
// share. A shared error changes the picture. An error in one eye only is rivalry, which looks like shimmer in
// depth.

#include <array>
#include <span>

#include "base/image.h"
#include "shared/types.h"

namespace binosplat::stereo {

struct Disagreement {
  double db = 0.0;       // -10 log10 of the mean squared difference; infinite without any; higher is better
  double counted = 0.0;  // share of the left eye's pixels that both eyes see; if it is 0, db is NaN
  Image picture;         // eL(p) - eR(p')| of RGB in the left eye; 0 for pixels that do not count
  Image right;           // eR(p') in the left eye; eL(p) for pixels that do not count
};

/// The error e of an eye is the approximate minus the exact colour, over black and not clamped. The result is
/// the mean difference between eL(p) and eR(p') over p and channels. p' is the point of the right picture
/// that shows the left pixel p, by its exact depth; eR is bilinear. A pixel counts if p has a depth, p' is
/// inside the right picture, and the right eye sees the point: its exact depth at the nearest pixel is within
/// 1 %. Left eye first. Throws Error unless all pictures have their view's size.
Disagreement disagreement(const std::array<shared::View, 2>& views, std::span<const Picture> exact,
                          std::span<const Picture> approximate);

}  // namespace binosplat::stereo
