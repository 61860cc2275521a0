#pragma once
// A smooth path through key cameras, for videos and for playback in a window.

#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "scene/camera.h"

namespace binosplat {

/// Returns whether all cameras have times, each later than the time before.
bool times_rise(std::span<const Camera> cameras);

/// Returns whether cameras are keys, and not the frames of a path. Keys have rising times with a median
/// interval above 0.1 s; a film's interval is shorter.
bool are_keys(std::span<const Camera> cameras);

/// A path through keys in their order. Positions, orientations and lenses follow cubics with continuous
/// velocity, and reach each key at its time. Before the first and after the last key the camera rests there.
class KeyPath {
 public:
  /// Without `seconds` the path uses the keys' own times, which must rise, relative to the first. With
  /// `seconds` it takes that long, at a pace as even as distances and rotations allow. Throws Error for fewer
  /// than two keys, times that do not rise, and seconds not above 0.
  explicit KeyPath(std::span<const Camera> keys, const std::optional<double>& seconds = {});

  double seconds() const { return knots_.back().at; }

  /// Returns the camera `seconds` after the first key, with that `time`. It has the first key's size; the
  /// lenses of all other cameras are resized() to it.
  Camera at(double seconds) const;

 private:
  struct Knot {
    double at = 0.0;  // s
    glm::dvec3 place{0.0}, velocity{0.0};
    glm::dquat orientation{1, 0, 0, 0};  // the camera's axes in the world
    glm::dvec3 angular_velocity{0.0};    // radians a second, in the camera's axes
    glm::dvec4 lens{0.0}, lens_velocity{0.0};
  };

  void pace(double seconds);
  void find_slopes();

  Camera first_;
  std::vector<Knot> knots_;
};

/// Samples a path at `frames_per_second` from its first key to its last, or to `seconds`. The cameras are
/// named path_00000 and so on. Throws Error for more than a million cameras.
std::vector<Camera> frames_of(const KeyPath& path, double frames_per_second,
                              double seconds = std::numeric_limits<double>::infinity());

}  // namespace binosplat
