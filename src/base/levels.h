#pragma once
// Display values as files of whole numbers keep them.

#include <algorithm>
#include <cmath>

namespace binosplat {

/// round(top clamp(value)), for a value from 0 to 1; 0 for one that is not a number.
inline long level_of(float value, float top) {
  return std::lround((value > 0.0f ? std::min(value, 1.0f) : 0.0f) * top);
}

}  // namespace binosplat
