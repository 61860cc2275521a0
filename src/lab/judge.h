#pragma once
// How far a stereo (or mono) frame is from the exact one: the numbers that docs/method.md 7 asks for.

#include <span>

#include "base/image.h"
#include "shared/types.h"

namespace binosplat::lab {

struct FrameErrors {
  double psnr = 0.0;         // dB, over the pixels of all eyes; infinite for equal frames
  double largest = 0.0;      // absolute error of a channel
  double p99 = 0.0;          // absolute error that 99 % of the channels keep
  double signed_mean = 0.0;  // approximate minus exact: below 0 where the picture darkens
  double edges = 0.0;  // RMS error on the outermost pixels of tiles over that inside them; 1 where tiles do
                       // not show, or there is no error
  double disagreement = 0.0;  // dB (stereo/disagreement.h); not a number for one eye
};

/// Over black, values clamped to [0, 1]. One picture a view; `tile_size` in px.
FrameErrors judge(std::span<const shared::View> views, std::span<const Picture> exact,
                  std::span<const Picture> approximate, int tile_size);

}  // namespace binosplat::lab
