#pragma once
// Stores the last frames of a Frame, and decides whether the next frame may use their measurements.

#include "render/frame_plan.h"
#include "shared/types.h"

namespace binosplat::render {

/// Whether `now` follows `before` without a camera cut. The views must be equal in number, size, lens and
/// regions. Each view may turn by at most 15 degrees and move by at most a tenth of `middle_depth` (of the
/// Gaussians that `before` drew, world units), both in the world and relative to each instance. An instance
/// may grow by at most a tenth. `share` scales these limits.
bool continues(const FramePlan& before, const FramePlan& now, double middle_depth, double share = 1.0);

/// About the geometric mean of the drawn Gaussians' depths, in world units; 0 if nothing was drawn.
double middle_depth(const shared::Counters& counters);

struct Measuring {
  bool uses_last = false;  // an earlier frame measured for this frame
  bool measures = false;   // this frame measures for later frames
};

class FrameHistory {
 public:
  /// The next frame uses no earlier measurements.
  void forget() { last_ = measured_ = {}; }
  /// Call it if `now` draws other levels of detail or instances of the same scene: drops measured
  /// transmittance.
  void follow(const FramePlan& now);

  bool continues_last(const FramePlan& now) const { return continues(last_, now, middle_depth_); }

  /// Whether `now` needs no probe. Every fourth frame needs a probe. So does a frame if, since the last
  /// probe, a view has gone a fifteenth of the way to a camera cut, such as a turn by a degree. Each call
  /// counts as a frame.
  bool has_recent_probe(const FramePlan& now);

  /// Decides whether the frame uses measurements, and whether it measures (FrameSettings::measure_every).
  Measuring decide(const FramePlan& now);

  void store(const FramePlan& drawn, const Measuring& measuring, const shared::Counters& counters);

 private:
  FramePlan last_;
  FramePlan measured_;  // the last frame that measured
  FramePlan probed_;    // the last frame with a probe
  double middle_depth_ = 0.0;
  int since_cut_ = 0;  // frames that used measurements since the cut
  int since_measured_ = 0;
  int since_probed_ = 0;
};

}  // namespace binosplat::render
