#pragma once
// A source carried along a path, frame by frame beside `one` with as many pairs: what the memory is
// worth, and whether it ever does harm.

#include <functional>
#include <vector>

#include "gl/context.h"
#include "study/stability.h"

namespace binosplat::study {

struct CarriedFrame {
  double db = 0.0;  // of the variant against exact
  double pairs = 0.0;
  double removed = 0.0;  // share of the exact frame's pairs
  double signed_mean = 0.0;
  bool fell_back = false;   // a measured source went by no last frame: the first one, a cut
  bool equals_one = false;  // equal bit for bit to `one` at the same loss; asked where it fell back
  double one_db = 0.0;      // of `one` at the loss that makes as many pairs, within 1 %
  double one_pairs = 0.0;
};

/// Draws the views of each frame in turn. `quality` above 0 steers the loss instead of the variant's own.
/// `progress` is called after each frame.
std::vector<CarriedFrame> run_carried(gl::Context& context, const Model& model,
                                      const std::vector<std::vector<shared::View>>& frames,
                                      const Variant& variant, float quality,
                                      const std::function<void()>& progress);

/// The loss at which the second frame, going by what an exact first one measured, comes to `target` dB.
float carried_loss(gl::Context& context, const Model& model,
                   const std::vector<std::vector<shared::View>>& frames, Variant variant, double target);

}  // namespace binosplat::study
