#pragma once
// Binocular disagreement (docs/method.md 6): the part of an approximation's error that the two eyes do not
// share. A shared error changes the picture; one that is in one eye only is rivalry, seen as shimmer in
// depth.

#include <array>
#include <span>

#include "base/image.h"
#include "shared/types.h"

namespace binosplat::stereo {

struct Disagreement {
  double db = 0.0;  // -10 log10 of the mean squared difference; infinite for none; higher is better
  double counted =
      0.0;        // share of the left eye's pixels that both eyes see; where it is 0, db is not a number
  Image picture;  // |eL(p) - eR(p')| of RGB in the left eye; 0 where not counted
  Image right;    // eR(p') in the left eye; eL(p) where not counted
};

/// With e the approximate minus the exact colour (over black, not clamped) of an eye: how far eL(p) is from
/// eR(p'), p' where the right eye sees what the left sees at p by its exact depth, eR taken bilinearly; the
/// mean over p and channels. Not counted: p without depth, p' outside the right picture, and what the right
/// eye does not see: its exact depth at the pixel nearest to p' is missing or more than 1 % off. Left eye
/// first; all pictures are the views' own. Throws Error for pictures that are not.
Disagreement disagreement(const std::array<shared::View, 2>& views, std::span<const Picture> exact,
                          std::span<const Picture> approximate);

}  // namespace binosplat::stereo
