#pragma once
// Controls the tolerance for `--quality` from frame to frame, without a calibration.

#include <cstdint>
#include <span>
#include <vector>

#include "render/frame_plan.h"
#include "render/settings.h"

namespace binosplat::render {

/// Chooses the tolerance of each frame from its probe and earlier probes. A probe has tiles evenly spread
/// over a view. Probes cycle through the views, and through the tiles of each view. The control aims at the
/// requested quality in the worst view; single frames may miss it by some tenths of a dB.
///
/// A rule's mean squared error grows as a power of its tolerance (docs/method.md 8: kappa^1.3, K^2 on trained
/// scenes; kappa^10 if thousands of similar Gaussians vanish at once). Each search after a camera cut
/// estimates the exponent again. Because the exponent varies, the tolerance falls at once and rises slowly.
/// The tolerance also follows small changes of the requested quality.
///
/// After a camera cut, a frame is drawn again until every view keeps the quality. A later frame is drawn
/// again if its probe shows much more error than expected. If a view is so small that a probe has all its
/// tiles, the frame is drawn again until all views were measured. The caller of an attempt calls next_probe()
/// and next_tolerance(), draws, and calls measured(). Another attempt follows unless is_final().
class ToleranceControl {
 public:
  /// Forgets the measurements, because the views changed. The tolerance stays as a first guess.
  void forget();

  /// Whether a frame of these settings can be drawn at tolerance() without a probe. False for views so small
  /// that a probe has all their tiles: single Gaussians may change their error by some dB per frame.
  bool is_settled(std::span<const shared::View> views, const FrameSettings& settings) const;
  float tolerance() const { return static_cast<float>(tolerance_); }

  /// The tiles that the next attempt also draws exactly. After a cut, these are all tiles of a view.
  Probe next_probe(std::span<const shared::View> views, const FrameSettings& settings);

  float next_tolerance();

  /// Stores the result of the attempt's probe. `settled` is false if later frames will use measured
  /// transmittance, but this one did not.
  void measured(const ProbeResult& probed, bool settled);

  bool is_final() const { return is_final_; }

  /// The estimated PSNR in dB of the worst view at the last tolerance; infinite for no error.
  double quality() const;
  /// Whether the last attempt measured all of its pixels; otherwise quality() is an estimate.
  bool is_measured() const;

 private:
  struct Estimate {
    double error = 0.0;      // mean squared error of the view's probed tiles
    double weight = 0.0;     // number of tiles; older tiles count less
    double tolerance = 0.0;  // the tolerance of `error`
    bool measured = false;   // the error was measured on the whole view, in this frame
  };
  // Of the attempts at one frame: the largest tolerance that kept the quality, the smallest that missed it,
  // and their errors.
  struct Bracket {
    double held = 0.0, held_error = 0.0;
    double missed = 0.0, missed_error = 0.0;
  };
  void begin(const FrameSettings& settings, double focal);
  double searched_tolerance(double target) const;
  double followed_tolerance(double target) const;
  void add_probe(const ProbeResult& probed);
  void learn(double target);
  double error_now(const Estimate& view) const;  // at the last tolerance
  double worst() const;                          // the largest error of the estimates
  double target() const;

  FrameSettings settings_;      // of the last frame
  double slope_ = 1.0;          // the squared error grows about as tolerance^slope_ here
  double tolerance_ = 0.0;      // of the last attempt that was not exact
  bool is_small_ = false;       // a probe has all tiles of a view
  bool after_cut_ = true;       // no frame was completed since the cut
  bool whole_probe_ = true;     // after a cut or a miss: the next probe has all tiles of a view
  std::size_t views_held_ = 0;  // number of views that keep the quality in the frame after a cut
  bool is_final_ = true;
  bool exact_ = false;  // whether this attempt is exact
  int attempts_ = 0;    // at this frame, for the probed view
  Bracket bracket_;
  std::uint32_t next_ = 0;    // index of the next probe, one per frame
  Probe probe_;               // of this attempt
  double probe_tiles_ = 0.0;  // number of tiles of probe_
  double unevenness_ = 0.0;   // ProbeResult::unevenness over the last probes
  std::vector<Estimate> views_;
};

}  // namespace binosplat::render
