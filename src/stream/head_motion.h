#pragma once
// Predicts the pose of a moving head.

#include <array>
#include <span>
#include <vector>

#include "base/clock.h"
#include "shared/types.h"

namespace binosplat {

/// Extrapolates the eyes' motion along a straight line, and their rotation, from the views of the last 0.1 to
/// 0.5 s. After a jump, or if the views come too rarely, it assumes no motion.
class HeadMotion {
 public:
  /// Adds a frame's views, always in the same coordinates. If their number changes, forgets earlier views.
  void note(std::span<const shared::View> views, Clock::time_point now = Clock::now());

  /// Returns the last noted views, extrapolated by `seconds`. If nothing moves, their bits stay the same.
  std::vector<shared::View> predicted(double seconds) const;

 private:
  struct Pose {
    std::vector<shared::View> views;
    Clock::time_point at;
  };
  std::vector<shared::View> views_;
  std::array<Pose, 3> poses_;  // latest first, at times far enough apart to measure a speed
};

}  // namespace binosplat
