#pragma once
// What a frame leaves for those that follow: its plan, by which they tell whether they show the same scene a
// moment later, so that what it measured still holds.

#include "render/frame_plan.h"
#include "shared/types.h"

namespace binosplat::render {

/// True if the views are the same ones a moment later: as many, of the same pictures and lenses, the same
/// regions of them drawn, each turned by no more than 15 degrees and moved by no more than a tenth of
/// `middle_depth` (of the Gaussians drawn before, world units), in the world and as each instance sees them.
/// Anything else is a camera cut. `share` scales these two limits.
bool continues(const FramePlan& before, const FramePlan& now, double middle_depth, double share = 1.0);

/// The depth of what a frame drew in the middle of a logarithmic scale, world units; 0 if it drew nothing.
double middle_depth(const shared::Counters& counters);

/// Whether a frame uses measured transmittance, and whether it measures.
struct Measuring {
  bool uses_last = false;  // an earlier frame measured for this one
  bool measures = false;   // this one measures for those to come
};

class FrameHistory {
 public:
  /// The next frame is as a first one.
  void forget() { last_ = measured_ = {}; }
  /// The next frame uses no measured transmittance.
  void forget_measured() { measured_ = {}; }
  /// What `now` draws are other Gaussians of the same scene: other levels of detail, or other instances.
  void follow(const FramePlan& now);

  /// Whether `now` follows the last frame without a camera cut.
  bool goes_on(const FramePlan& now) const { return continues(last_, now, middle_depth_); }

  /// Whether `now` needs no probe, of its error: one in four frames measures that, and each whose eyes have
  /// gone a fifteenth of the way to a camera cut since the last that did, such as a turn by a degree. Counts
  /// the frames that ask.
  bool probed_lately(const FramePlan& now);

  /// Whether the frame uses what was measured, and whether it measures (FrameSettings::measure_every).
  Measuring decide(const FramePlan& now);

  /// Remembers a frame that was drawn.
  void keep(const FramePlan& drawn, const Measuring& measuring, const shared::Counters& counters);

 private:
  FramePlan last_;
  FramePlan measured_;  // the last one that measured
  FramePlan probed_;    // the last one with a probe
  double middle_depth_ = 0.0;
  int since_cut_ = 0;  // frames that used what was measured
  int since_measured_ = 0;
  int since_probed_ = 0;
};

}  // namespace binosplat::render
