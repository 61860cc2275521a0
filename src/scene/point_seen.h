#pragma once
// Where a camera sees a point.

#include <glm/glm.hpp>

#include "scene/camera.h"

namespace binosplat {

/// A point as a camera sees it.
struct PointSeen {
  double ahead = 0.0;    // how far along the camera's axis, world units; below 0 behind it
  glm::dvec2 at{0.0};    // px from the picture's upper left corner, where it lies ahead
  glm::dvec2 size{0.0};  // the picture's, px

  /// Whether it lies in the picture, at least `margin` px from its sides.
  bool is_within(double margin) const {
    return at.x >= margin && at.x < size.x - margin && at.y >= margin && at.y < size.y - margin;
  }
};

/// The camera and the point in one frame.
inline PointSeen see(const Camera& camera, const glm::vec3& point) {
  const glm::dvec3 v = glm::transpose(camera.rotation) * (glm::dvec3(point) - camera.position);
  return {v.z,
          {camera.fx * v.x / v.z + camera.cx, camera.fy * v.y / v.z + camera.cy},
          {camera.width, camera.height}};
}

}  // namespace binosplat
