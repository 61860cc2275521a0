#pragma once
// --quality: finds from frame to frame, without calibration, which tolerance keeps frames at a wanted error.

#include <cstdint>
#include <span>
#include <vector>

#include "render/frame_plan.h"
#include "render/settings.h"

namespace binosplat::render {

/// Chooses the tolerance of each frame by what probes of it and of frames before showed. A probe has tiles
/// evenly spread over a view; probes take views, and the tiles of each, in turn. The control aims at the
/// quality asked for in the view that errs most; single frames may miss it by some tenths of a dB. A rule's
/// mean squared error grows as a power of its tolerance (docs/method.md 8: kappa^1.3, K^2 on trained scenes;
/// kappa^10 where thousands of like Gaussians go at once), which each search after a camera cut finds anew;
/// so the tolerance falls at once and rises carefully. The quality asked for may change a little from frame
/// to frame; the tolerance follows it likewise.
///
/// A frame that does not hold is to be drawn again: after a camera cut, until every view was seen to hold, or
/// where a probe shows much more error than was expected; and where a view has so few tiles that a
/// probe has all of them, until all views were measured. Each attempt is
///   next_probe(), next_tolerance(), the drawing, measured(), and again unless holds().
class ToleranceControl {
 public:
  /// Forgets what was measured, which is of other views. The tolerance stays, as a first guess.
  void forget();

  /// Whether enough is known of a frame of these settings to draw it at tolerance(), without a probe. Never
  /// of views that a probe has all of: single Gaussians may change their error by some dB a frame.
  bool knows(std::span<const shared::View> views, const FrameSettings& settings) const;
  float tolerance() const { return static_cast<float>(tolerance_); }

  /// The tiles that the next attempt draws exactly, too: after a cut all of a view's.
  Probe next_probe(std::span<const shared::View> views, const FrameSettings& settings);

  /// The tolerance for the next attempt.
  float next_tolerance();

  /// Takes what the attempt's probe showed. `settled`: the frame used measured transmittance, if later ones
  /// will.
  void measured(const Probed& probed, bool settled);

  /// Whether the last attempt is the frame.
  bool holds() const { return holds_; }

  /// PSNR in dB of the view that errs most, at the tolerance last given, as far as is known; infinite for no
  /// error.
  double quality() const;
  /// Whether the last attempt measured that on all that it drew. Else it is an estimate.
  bool is_measured() const;

 private:
  struct Estimate {
    double error = 0.0;      // mean squared error of the view's tiles that were seen
    double weight = 0.0;     // how many tiles; those seen longer ago count less
    double tolerance = 0.0;  // to which `error` belongs
    bool measured = false;   // on all of the view as it is in this frame
  };
  // The largest tolerance that attempts at one frame showed to hold, the smallest shown to miss, and their
  // errors.
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
  double worst() const;                          // the largest error of the estimates
  double target() const;

  FrameSettings settings_;  // the last frame's
  double slope_ = 1.0;      // squared error grows about as tolerance^slope_ here
  double tolerance_ = 0.0;  // the last attempt's that was not exact
  bool is_small_ = false;   // a probe has all tiles of a view
  bool cut_ = true;         // no frame was kept since the cut
  bool fresh_ = true;       // after a cut or a miss: the next probe has all of a view
  std::size_t found_ = 0;   // views that hold in the frame after a cut
  bool holds_ = true;
  bool exact_ = false;  // whether this attempt is exact
  int attempts_ = 0;    // at this frame, to find this view's tolerance
  Bracket bracket_;
  std::uint32_t next_ = 0;    // number of the next probe in their order, one a frame
  Probe probe_;               // this attempt's
  double probe_tiles_ = 0.0;  // how many tiles it has
  double unevenness_ = 0.0;   // Probed::unevenness, as the last probes show it
  std::vector<Estimate> views_;
};

}  // namespace binosplat::render
