#pragma once
// Unit quaternions stored as their three smallest components, as in packed formats.

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

namespace binosplat {

/// The largest component follows from the others. If it is negative, smallest_three() negates the quaternion.
struct SmallestThree {
  int largest = 0;       // index of the omitted, largest component
  glm::dvec3 others{0};  // in ascending order of their indices, each within +-sqrt(1/2)

  glm::dvec4 quaternion() const {
    glm::dvec4 q(0.0);
    double rest = 1.0;
    for (int c = 0, k = 0; c < 4; ++c) {
      if (c == largest) continue;
      q[c] = others[k++];
      rest -= q[c] * q[c];
    }
    q[largest] = std::sqrt(std::max(rest, 0.0));
    return q;
  }
};

template <typename Quaternion>
SmallestThree smallest_three(const Quaternion& q) {
  SmallestThree out;
  for (int c = 1; c < 4; ++c) {
    if (std::abs(q[c]) > std::abs(q[out.largest])) out.largest = c;
  }
  for (int c = 0, k = 0; c < 4; ++c) {
    if (c != out.largest) out.others[k++] = q[out.largest] < 0 ? -q[c] : q[c];
  }
  return out;
}

}  // namespace binosplat
