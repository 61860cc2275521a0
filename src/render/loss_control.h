#pragma once
// --quality: which loss keeps frames at a wanted error, found from frame to frame without calibration.

#include <cstdint>
#include <span>
#include <vector>

#include "render/settings.h"
#include "render/shape.h"

namespace binosplat::render {

/// Chooses the loss of each frame. A rule's mean squared error grows as a power of its loss (METHOD 8:
/// kappa^1.3, K^2), so what one strip of a view cost at one loss says what it would cost at another. The
/// strips of all views are probed in turn, recent ones count for more, and the loss is set to where their
/// mean meets the target. It starts with a loss that is careful on our scenes and moves by at most a third a
/// frame.
class LossControl {
 public:
  /// The strip that the next frame of these views draws exactly, too.
  Probe next_probe(std::span<const shared::View> views, const FrameSettings& settings);

  /// The loss for a frame; `cut`: what was measured so far is of other views.
  float next_loss(const FrameSettings& settings, bool cut);

  /// What that frame's probe showed: the mean squared error over its pixels and channels. Not for a frame
  /// that went by no measurement while its successors will: it errs less than they do.
  void measured(double squared_error);

  /// PSNR in dB that the frames come to at the loss last given, as far as is known; infinite for no error.
  double quality() const;

 private:
  struct Sample {
    double error_at_one = 0.0;  // squared error, scaled to a loss of 1
    double weight = 0.0;
  };
  void reset(const FrameSettings& settings);
  double error_at_one() const;

  FrameSettings settings_;  // of the frames so far
  double power_ = 1.0;      // squared error grows as loss^power_
  double loss_ = 0.0;
  double focal_ = 0.0;           // px
  bool fresh_ = true;            // no sample counts yet
  std::uint32_t next_ = 0;       // of the strips, in the order in which they are probed
  std::size_t probed_ = 0;       // sample of the frame at hand
  Sample start_;                 // stands for what is not measured yet
  std::vector<Sample> samples_;  // (view, strip)
};

}  // namespace binosplat::render
