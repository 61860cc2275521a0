#pragma once
// Stores the last frames of a Frame, and decides whether the next frame may use their measurements.

#include "render/frame_plan.h"
#include "shared/types.h"

namespace binosplat::render {

/// The motion from `before` to `now`, as a share of a camera cut; above 1 is a cut. A cut is a turn of a view
/// by 15 degrees, a move by a tenth of `middle_depth` (of the Gaussians that `before` drew, world units),
/// both in the world and relative to each instance, or an instance that grows by a tenth. Infinite if the
/// views differ in number, size, lens or regions, or the models in size.
double motion(const FramePlan& before, const FramePlan& now, double middle_depth);

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

  /// The motion from the last frame to `now`.
  double motion_to(const FramePlan& now) const { return motion(last_, now, middle_depth_); }

  /// Decides whether the frame uses measurements, and whether it measures (FrameSettings::measure_every).
  Measuring decide(const FramePlan& now);

  void store(const FramePlan& drawn, const Measuring& measuring, const shared::Counters& counters);

 private:
  FramePlan last_;
  FramePlan measured_;  // the last frame that measured
  double middle_depth_ = 0.0;
  int since_cut_ = 0;  // frames that used measurements since the cut
  int since_measured_ = 0;
};

}  // namespace binosplat::render
