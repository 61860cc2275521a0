#pragma once
// --quality: which loss keeps frames at a wanted error, found from frame to frame without calibration.

#include <cstdint>
#include <span>
#include <vector>

#include "render/settings.h"
#include "render/shape.h"

namespace binosplat::render {

/// Chooses the loss of each frame by what probes of it and of those before showed: tiles evenly spread over a
/// view, in turn over all views and all of their tiles. A rule's mean squared error grows as a power of its
/// loss (METHOD 8: kappa^1.3, K^2), so what a probe cost at one loss says what it would cost at another. The
/// view that errs most must keep the promise.
///
/// A frame that does not hold is to be drawn again: one after a cut, of which nothing was known, or one whose
/// probe shows what nobody could foresee. Each attempt is
///   next_probe(), next_loss(), the drawing, measured(), and again unless holds().
class LossControl {
 public:
  /// What was measured so far is of other views. The loss stays, as a first guess.
  void forget();

  /// The tiles that the next attempt draws exactly, too: after a cut more of them.
  Probe next_probe(std::span<const shared::View> views, const FrameSettings& settings);

  /// The loss for the next attempt.
  float next_loss(const FrameSettings& settings);

  /// What its probe showed: the mean squared error over its pixels and channels. `settled`: the frame went by
  /// all that its successors will go by.
  void measured(double squared_error, bool settled);

  /// Whether the last attempt is the frame.
  bool holds() const { return holds_; }

  /// PSNR in dB of the view that errs most, at the loss last given, as far as is known; infinite for no
  /// error.
  double quality() const;

 private:
  struct Estimate {
    double error_at_one = 0.0;  // squared error, scaled to a loss of 1: mean of what was seen,
    double weight = 0.0;        // of so many tiles, fewer the longer ago
  };
  void begin(const FrameSettings& settings);
  void take(double error_at_one);
  bool keeps_promise() const;
  bool any_known() const;
  double most_at_one() const;
  double error_now() const;  // of the worst view, at the loss last given

  FrameSettings settings_;  // of the frames so far
  double power_ = 1.0;      // squared error grows as loss^power_,
  double slope_ = 1.0;      // and about here as loss^slope_
  double loss_ = 0.0;       // of the last attempt
  double focal_ = 0.0;      // px
  bool fresh_ = true;       // no frame was kept since the cut
  bool holds_ = true;
  bool exact_ = false;                         // the attempt at hand
  int attempts_ = 0;                           // at the frame at hand
  std::uint32_t next_ = 0;                     // of the probes, in their order
  Probe probe_;                                // of the attempt at hand
  double probe_tiles_ = 0.0;                   // of it
  double last_loss_ = 0.0, last_error_ = 0.0;  // of the attempt before, for the slope between
  std::vector<Estimate> views_;
};

}  // namespace binosplat::render
