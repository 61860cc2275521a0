#pragma once
// --quality: which tolerance keeps frames at a wanted error, found from frame to frame without calibration.

#include <cstdint>
#include <span>
#include <vector>

#include "render/frame_plan.h"
#include "render/settings.h"

namespace binosplat::render {

/// Chooses the tolerance of each frame by what probes of it and of those before showed: tiles evenly spread
/// over a view, in turn over all views and all of their tiles. The view that errs most must keep the promise.
/// A rule's mean squared error grows as a power of its tolerance (docs/method.md 8: kappa^1.3, K^2 on trained
/// scenes; kappa^10 where thousands of like Gaussians go at once), which each search after a camera cut finds
/// anew; so the tolerance falls at once and rises carefully. A quality that is asked for may change a little
/// from frame to frame, and is followed likewise.
///
/// A frame that does not hold is to be drawn again: one after a camera cut, until every view was seen to
/// hold, or one whose probe shows what nobody could foresee. Each attempt is
///   next_probe(), next_tolerance(), the drawing, measured(), and again unless holds().
class ToleranceControl {
 public:
  /// What was measured so far is of other views. The tolerance stays, as a first guess.
  void forget();

  /// Whether enough is known of a frame of these settings to draw it at tolerance(), without a probe.
  bool knows(const FrameSettings& settings) const;
  float tolerance() const { return static_cast<float>(tolerance_); }

  /// The tiles that the next attempt draws exactly, too: after a cut all of a view's.
  Probe next_probe(std::span<const shared::View> views, const FrameSettings& settings);

  /// The tolerance for the next attempt.
  float next_tolerance();

  /// What its probe showed. `settled`: the frame went by all that its successors will go by.
  void measured(const Probed& probed, bool settled);

  /// Whether the last attempt is the frame.
  bool holds() const { return holds_; }

  /// PSNR in dB of the view that errs most, at the tolerance last given, as far as is known; infinite for no
  /// error.
  double quality() const;

 private:
  struct Estimate {
    double error = 0.0;      // squared error of a view: mean of what was seen,
    double weight = 0.0;     // of so many tiles, fewer the longer ago,
    double tolerance = 0.0;  // as of this tolerance
  };
  // Of the attempts at one frame: the largest tolerance seen to hold and the smallest seen to miss, and what
  // they cost.
  struct Bracket {
    double held = 0.0, held_error = 0.0;
    double missed = 0.0, missed_error = 0.0;
  };
  void begin(const FrameSettings& settings, double focal);
  double searched_tolerance(double target) const;
  double followed_tolerance(double target) const;
  void take(const Probed& probed);
  void learn(double target);
  double error_now(const Estimate& view) const;  // at the tolerance last given
  double worst() const;                          // of the estimates
  double target() const;

  FrameSettings settings_;  // of the frames so far
  double slope_ = 1.0;      // squared error grows about as tolerance^slope_ here
  double tolerance_ = 0.0;  // of the last attempt that was not exact
  bool cut_ = true;         // no frame was kept since the cut
  bool fresh_ = true;       // nor did the last attempt hold: all of a view is to be seen
  std::size_t found_ = 0;   // views that hold in the frame after a cut
  bool holds_ = true;
  bool exact_ = false;  // the attempt at hand
  int attempts_ = 0;    // at the frame at hand, to find this view's tolerance
  Bracket bracket_;
  std::uint32_t next_ = 0;    // of the probes, in their order: one a frame
  Probe probe_;               // of the attempt at hand
  double probe_tiles_ = 0.0;  // of it
  double unevenness_ = 0.0;   // of tiles, as probes show it
  std::vector<Estimate> views_;
};

}  // namespace binosplat::render
