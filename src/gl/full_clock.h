#pragma once
// Measures while the GPU runs at its full clock. A GPU that was idle, is hot or serves other programs gives
// times that are up to four times too long, and says nothing about it.

#include <cmath>
#include <functional>

#include "base/clock.h"
#include "gl/context.h"

namespace binosplat::gl {

class FullClock {
 public:
  /// `probe_ms` returns the time of some fixed work, which grows as the clock falls.
  explicit FullClock(std::function<double()> probe_ms) : probe_ms_(std::move(probe_ms)) {}
  /// Times a small dispatch, first for a second, in which the clock rises. A software renderer always counts
  /// as being at its full clock.
  explicit FullClock(Context& context);

  /// Calls `measure` again while the clock before or after it was below 95 % of the highest one that this
  /// object has seen, at most five times. Returns whether the last call counts. `measure` must replace its
  /// earlier result.
  bool measure(const std::function<void()>& measure);

 private:
  double probe();

  std::function<double()> probe_ms_;
  double shortest_ms_ = INFINITY;
};

/// Draws for `ms` to raise the clock of a GPU that was idle; a second or less suffices. Does nothing for a
/// software renderer.
template <typename Draw>
void raise_clock(const Context& context, double ms, const Draw& draw) {
  if (context.software()) return;
  const auto start = Clock::now();
  while (ms_since(start) < ms) draw();
}

}  // namespace binosplat::gl
