#pragma once
// What frames leave for those that follow: whether it is the same scene a moment later, and what of it was
// measured.

#include "render/shape.h"
#include "shared/types.h"

namespace binosplat::render {

/// True if the views are the same ones a moment later: as many, of the same pictures and lenses, the same
/// parts of them drawn, each turned by less than 15 degrees and moved by less than a tenth of `median_depth`
/// (of the Gaussians drawn before, world units). Anything else is a cut.
/// `share` of these limits, for a closer look.
bool continues(const FrameShape& before, const FrameShape& now, double median_depth, double share = 1.0);

class FrameHistory {
 public:
  /// The next frame comes after none.
  void forget() { last_ = measured_ = {}; }
  /// The next frame goes by nothing measured.
  void forget_measured() { measured_ = {}; }
  /// The model has so many Gaussians now: other levels of detail of the same scene.
  void follow_levels(std::uint32_t gaussians);

  /// Whether `now` follows the last frame without a cut.
  bool goes_on(const FrameShape& now) const { return continues(last_, now, median_depth_); }

  /// Whether `now` needs no probe: the last one is not long ago and was of nearly the same views
  /// (FrameSettings::probe_every). Counts the frames that ask.
  bool probed_lately(const FrameShape& now);

  /// Sets whether the frame goes by what was measured, and whether it measures (FrameSettings::record_every).
  void decide(FrameShape& now);

  /// The frame is drawn.
  void keep(const FrameShape& drawn, const shared::Counters& counters);

 private:
  FrameShape last_;
  FrameShape measured_;  // the last one that measured
  FrameShape probed_;    // the last one with a probe
  double median_depth_ = 0.0;
  int since_cut_ = 0;  // frames that went by what was measured
  int since_measured_ = 0;
  int since_probed_ = 0;
};

}  // namespace binosplat::render
