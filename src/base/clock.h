#pragma once
// A monotonic clock.

#include <chrono>

namespace binosplat {

using Clock = std::chrono::steady_clock;

inline double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace binosplat
