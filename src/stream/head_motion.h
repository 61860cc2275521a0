#pragma once
// Predicts the pose of a moving head.

#include <array>
#include <span>
#include <vector>

#include "base/clock.h"
#include "shared/types.h"

namespace binosplat {

/// Extrapolates the eyes' motion along a straight line and their rotation, from the views of the last tenth
/// of a second or two. Jumps count as no motion, and so do views that are noted too rarely.
class HeadMotion {
 public:
  /// Adds the views of a frame, all in one frame of reference. It restarts if their number changes.
  void note(std::span<const shared::View> views, Clock::time_point now = Clock::now());

  /// Returns the views noted last, extrapolated by `seconds`; the same bits if nothing moves.
  std::vector<shared::View> predicted(double seconds) const;

 private:
  struct Pose {
    std::vector<shared::View> views;
    Clock::time_point at;
  };
  std::vector<shared::View> views_;
  std::array<Pose, 3> poses_;  // the latest first, far enough apart in time to measure a speed
};

}  // namespace binosplat
