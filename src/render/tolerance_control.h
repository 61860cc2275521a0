#pragma once
// Chooses the tolerance for `--quality` from frame to frame, without a calibration.

#include <binosplat/report.h>

#include <optional>
#include <span>
#include <vector>

#include "render/frame_plan.h"
#include "render/frame_settings.h"

namespace binosplat::render {

/// A Kalman filter over the frames. It estimates the logarithm of each view's mean squared error at the
/// present tolerance, and the exponent with which all errors grow with the tolerance. Motion adds variance,
/// probes (error samples) remove it. The tolerance is the largest one at which the worst view keeps the
/// quality, with a margin of some standard deviations.
///
/// A frame is drawn once. It is exact if too little is known of its error, or if a tolerance would save too
/// little time. A probe of an exact frame has the tolerance, so the search goes on while frames are exact.
/// Settings without a threshold leave the rule to it, too: `squared`, or where tiles have long lists
/// AdaGScale. All decisions come from counts, never from a clock, so that two runs draw the same pictures.
class ToleranceControl {
 public:
  struct Choice {
    ExactReason exact = ExactReason::not_exact;
    Threshold threshold = Threshold::squared;  // of the frame, or of the probe of an exact frame
    float tolerance = 0.0f;                    // likewise
    std::optional<Probe> probe;
  };
  /// The choice for the next frame. `motion` is the motion since the last frame, as a share of a camera cut
  /// (history.h).
  Choice choose(std::span<const shared::View> views, const FrameSettings& settings, double motion);

  /// Stores the counts of the chosen frame, without its probe: Gaussian-tile pairs, and Gaussians of the
  /// models.
  void drew(double pairs, double gaussians);
  /// Stores the result of the chosen frame's probe.
  void measured(const ProbeResult& probe);

  /// The estimated PSNR in dB of the worst view at the chosen tolerance.
  double quality() const;

 private:
  Threshold rule(std::span<const shared::View> views, const FrameSettings& settings) const;
  void start(const FrameSettings& settings, std::size_t views, double focal);
  void forget();
  void add_variance(double variance);
  void set_tolerance(double log_tolerance);
  double& covariance(std::size_t a, std::size_t b) { return covariance_[a * mean_.size() + b]; }
  double deviation(std::size_t view) const;
  double largest_deviation() const;
  double excess_error(double target) const;
  bool pays(std::span<const shared::View> views, double kept, double limit) const;
  Probe next_probe(std::span<const shared::View> views, const FrameSettings& settings);
  std::size_t view_count() const { return mean_.size() - 1; }

  FrameSettings settings_;
  double log_tolerance_ = 0.0;
  std::vector<double> mean_{1.0};        // by view: log(error); the last one is the exponent
  std::vector<double> covariance_{1.0};  // of mean_
  Choice choice_;
  int frames_ = 0;                // since a cut
  int since_probe_ = 0;           // frames
  int unsure_probes_ = 0;         // successive probes while too little was known
  std::uint32_t next_probe_ = 0;  // index of the next probe
  double exact_pairs_ = -1.0;     // pairs that the last frame has, or would have, exactly; below 0: no frame
  double kept_ = 0.0;             // share of the exact pairs that a tolerance keeps; 0: unknown
  double unevenness_ = 0.0;       // of the last probe
  double probe_share_ = 0.0;      // a probe's share of the tiles of all views
  double gaussians_ = 0.0;
};

}  // namespace binosplat::render
