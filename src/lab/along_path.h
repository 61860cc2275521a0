#pragma once
// A source along a path, frame by frame beside `one` with as many pairs: what the memory is
// worth, and whether it ever does harm.

#include <functional>
#include <vector>

#include "gl/context.h"
#include "lab/stability.h"

namespace binosplat::lab {

struct PathFrame {
  double db = 0.0;  // of the variant against exact
  double pairs = 0.0;
  double removed = 0.0;  // share of the exact frame's pairs
  double signed_mean = 0.0;
  bool fell_back = false;   // a measured source went by no last frame: the first one, a cut
  bool equals_one = false;  // equal bit for bit to `one` at the same tolerance; asked where it fell back
  double one_db = 0.0;      // of `one` at the tolerance that makes as many pairs, within 1 %
  double one_pairs = 0.0;
};

/// Draws the views of each frame in turn. `quality` above 0 steers the tolerance instead of the variant's
/// own. `progress` is called after each frame.
std::vector<PathFrame> draw_along_path(gl::Context& context, const Model& model,
                                       const std::vector<std::vector<shared::View>>& frames,
                                       const Variant& variant, float quality,
                                       const std::function<void()>& progress);

/// The tolerance at which the second frame, going by what an exact first one measured, comes to `target` dB.
float tolerance_along_path(gl::Context& context, const Model& model,
                           const std::vector<std::vector<shared::View>>& frames, Variant variant,
                           double target);

}  // namespace binosplat::lab
