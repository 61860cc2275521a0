#pragma once
// What frames leave for those that follow: whether it is the same scene a moment later, and what of it was
// measured.

#include "render/frame_plan.h"
#include "shared/types.h"

namespace binosplat::render {

/// True if the views are the same ones a moment later: as many, of the same pictures and lenses, the same
/// regions of them drawn, each turned by less than 15 degrees and moved by less than a tenth of
/// `median_depth` (of the Gaussians drawn before, world units). Anything else is a camera cut. `share` of
/// these limits, to ask for less.
bool continues(const FramePlan& before, const FramePlan& now, double median_depth, double share = 1.0);

/// What measured transmittance has to do with a frame.
struct Measuring {
  bool uses_last = false;  // an earlier frame measured for this one
  bool measures = false;   // this one measures for those to come
};

class FrameHistory {
 public:
  /// The next frame comes after none.
  void forget() { last_ = measured_ = {}; }
  /// The next frame goes by nothing measured.
  void forget_measured() { measured_ = {}; }
  /// The model has so many Gaussians now: other levels of detail of the same scene.
  void follow_levels(std::uint32_t gaussians);

  /// Whether `now` follows the last frame without a camera cut.
  bool goes_on(const FramePlan& now) const { return continues(last_, now, median_depth_); }

  /// Whether `now` needs no probe: the last one is not long ago, fewer than `probe_every` frames
  /// (Workings), and was of nearly the same views. Counts the frames that ask.
  bool probed_lately(const FramePlan& now, int probe_every);

  /// Whether the frame uses what was measured, and whether it measures (FrameSettings::measure_every).
  Measuring decide(const FramePlan& now);

  /// The frame is drawn.
  void keep(const FramePlan& drawn, const Measuring& measuring, const shared::Counters& counters);

 private:
  FramePlan last_;
  FramePlan measured_;  // the last one that measured
  FramePlan probed_;    // the last one with a probe
  double median_depth_ = 0.0;
  int since_cut_ = 0;  // frames that went by what was measured
  int since_measured_ = 0;
  int since_probed_ = 0;
};

}  // namespace binosplat::render
