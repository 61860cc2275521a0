#pragma once
// Where a head that moves will be in a moment.

#include <array>
#include <span>
#include <vector>

#include "base/clock.h"
#include "shared/types.h"

namespace binosplat {

/// Predicts from the views of the last tenth of a second or two that eyes go on along a straight line, and go
/// on turning. Views that jump from one place to another have no motion, nor have views that are noted too
/// rarely.
class HeadMotion {
 public:
  /// Takes the views of a frame, in one frame of reference. It begins anew where there are more or fewer than
  /// before.
  void note(std::span<const shared::View> views, Clock::time_point now = Clock::now());

  /// The views noted last, as they will be in `seconds`; the same bits where nothing moves.
  std::vector<shared::View> ahead(double seconds) const;

 private:
  struct Pose {
    std::vector<shared::View> views;
    Clock::time_point at;
  };
  std::vector<shared::View> views_;
  std::array<Pose, 3> poses_;  // the latest first, far enough apart in time to tell a speed
};

}  // namespace binosplat
