#pragma once
// A pinhole camera in float64, and its View for shaders.

#include <binosplat/eyes.h>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "shared/types.h"

namespace binosplat {

/// World to camera is v = transpose(rotation) * (p - position). A point projects to (fx v.x / v.z + cx - 0.5,
/// fy v.y / v.z + cy - 0.5) px, where the centre of pixel (i, j) is (i, j).
struct Camera {
  std::string name;
  int width = 0;   // px
  int height = 0;  // px
  double fx = 0;   // px
  double fy = 0;
  double cx = 0;  // px from the picture's left edge; width / 2 is centred
  double cy = 0;
  glm::dvec3 position{0.0};
  glm::dmat3 rotation{1.0};    // columns: the camera's axes x right, y down, z forward in the world
  std::optional<double> time;  // s, for cameras of a path
  std::string short_name;  // shortest suffix of `name` that is unique in its file; set_short_names() sets it
};

/// Sets the focal lengths and the middle of a picture that has its size.
void set_vertical_fov(Camera& camera, double degrees);

/// Sets lens, slopes, width and height of a View.
void set_lens(shared::View& view, const Camera& camera);

/// Returns the camera as shaders use it. Positions are relative to `anchor`, a point near all views of a
/// frame (shared/types.h); the eyes of a rig share it. Frame later sets tiles, offsets and groups.
shared::View make_view(const Camera& camera, const glm::vec3& anchor, double near_plane);

/// The same for a single camera, anchored at its own position.
shared::View make_view(const Camera& camera, double near_plane = near_default);

/// A point in a camera's picture.
struct ProjectedPoint {
  double depth = 0.0;    // distance along the camera's axis, world units; below 0 behind the camera
  glm::dvec2 at{0.0};    // px from the picture's upper left corner; valid if `depth` is above 0
  glm::dvec2 size{0.0};  // size of the picture, px

  /// Returns whether the point lies at least `margin` px within the picture. The caller checks `depth`.
  bool is_within(double margin) const {
    return at.x >= margin && at.x < size.x - margin && at.y >= margin && at.y < size.y - margin;
  }
};

/// Returns the direction of the ray through a point of the picture, px from the upper left corner: at view
/// depth z it reaches camera.position + z * direction.
inline glm::dvec3 ray_through(const Camera& camera, const glm::dvec2& at) {
  return camera.rotation * glm::dvec3((at.x - camera.cx) / camera.fx, (at.y - camera.cy) / camera.fy, 1.0);
}

/// Projects a point into a camera's picture. Point and camera use one frame of reference.
inline ProjectedPoint project_point(const Camera& camera, const glm::vec3& point) {
  const glm::dvec3 v = glm::transpose(camera.rotation) * (glm::dvec3(point) - camera.position);
  return {v.z,
          {camera.fx * v.x / v.z + camera.cx, camera.fy * v.y / v.z + camera.cy},
          {camera.width, camera.height}};
}

/// Returns the camera at another size. The vertical field of view and the pixel aspect stay; a principal
/// point off the centre keeps its angle.
Camera resized(const Camera& camera, int width, int height);

/// Returns a camera at `eye` that looks at `at`; `up` appears upwards in the picture; `fov_degrees` is the
/// vertical field of view. Throws Error if the three vectors define no orientation.
Camera look_at(const glm::dvec3& eye, const glm::dvec3& at, const glm::dvec3& up, double fov_degrees,
               int width, int height);

}  // namespace binosplat
