#pragma once
// Where a head that moves will be in a moment.

#include <array>
#include <span>
#include <vector>

#include "base/clock.h"
#include "shared/types.h"

namespace binosplat {

/// Goes by the views of the last tenth of a second or two: eyes go on along a straight line, and turn as they
/// do. What only jumps from one place to another has no motion, nor has what is seen too rarely to tell.
class HeadMotion {
 public:
  /// The views of a frame, always as many, in one frame of reference. From where there are more or fewer it
  /// begins anew.
  void note(std::span<const shared::View> views, Clock::time_point now = Clock::now());

  /// The views noted last, as they will be in so many seconds; the same bits where nothing moves.
  std::vector<shared::View> ahead(double seconds) const;

 private:
  struct Pose {
    std::vector<shared::View> views;
    Clock::time_point at;
  };
  std::vector<shared::View> views_;
  std::array<Pose, 3> poses_;  // apart enough to tell how fast; the latest first
};

}  // namespace binosplat
