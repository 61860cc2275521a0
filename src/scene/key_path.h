#pragma once
// A smooth way through cameras that somebody set as keys: for videos, and for playing them in a window.

#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "scene/camera.h"

namespace binosplat {

/// Whether all cameras have times, each later than the one before.
bool times_rise(std::span<const Camera> cameras);

/// Whether cameras are keys to go through, and not themselves the frames of a path: their times rise, and
/// are more than 0.1 s apart in the median, as no film's frames are.
bool are_keys(std::span<const Camera> cameras);

/// The way through keys in their order: places, orientations and lenses by cubics that meet each key at its
/// time and have one velocity on both sides of it. Rests before the first and after the last key.
class KeyPath {
 public:
  /// Without `seconds` the path takes the keys' own times, which must rise, from the first one on; with them
  /// it takes that long, at a pace as even as places and turns allow. Throws Error for fewer than two keys,
  /// times that do not rise, and seconds that are not above 0.
  explicit KeyPath(std::span<const Camera> keys, const std::optional<double>& seconds = {});

  /// How long it takes from the first key to the last.
  double seconds() const { return knots_.back().at; }

  /// The camera `seconds` after the first key, with that `time`. Its size is the first key's, to which the
  /// others' lenses are resized().
  Camera at(double seconds) const;

 private:
  struct Knot {
    double at = 0.0;  // s
    glm::dvec3 place{0.0}, going{0.0};
    glm::dquat turned{1, 0, 0, 0};  // the camera's axes in the world
    glm::dvec3 turning{0.0};        // radians a second, in the camera's axes
    glm::dvec4 lens{0.0}, zooming{0.0};
  };

  void pace(double seconds);
  void find_slopes();

  Camera first_;
  std::vector<Knot> knots_;
};

/// The cameras of a path, `frames_per_second` from its first key to its last or before `seconds`, called
/// path_00000 and so on. Throws Error for more than a million.
std::vector<Camera> frames_of(const KeyPath& path, double frames_per_second,
                              double seconds = std::numeric_limits<double>::infinity());

}  // namespace binosplat
