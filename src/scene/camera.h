#pragma once
// A pinhole camera in float64, and the View that shaders see of it.

#include <binosplat/eyes.h>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "shared/types.h"

namespace binosplat {

/// World to camera is v = transpose(rotation) * (p - position); a point projects to
/// (fx v.x / v.z + cx - 0.5, fy v.y / v.z + cy - 0.5) px, where the centre of pixel (i, j) is (i, j).
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
  std::string short_name;  // what tells it from others of its file; set_short_names() (formats/view_files.h)
};

/// Fills in what a View says of the camera's lens and picture: lens, slopes, width and height.
void set_lens(shared::View& view, const Camera& camera);

/// The camera as shaders see it. `anchor` is the point near all views of a frame that positions are taken
/// relative to (see shared/types.h); pass the same one for the eyes of a rig. The frame fills in tiles,
/// offsets and groups.
shared::View make_view(const Camera& camera, const glm::vec3& anchor, double near_plane);

/// The same for a camera by itself: anchored at its own position.
shared::View make_view(const Camera& camera, double near_plane = near_default);

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

/// Where a camera sees a point of its frame.
inline PointSeen see(const Camera& camera, const glm::vec3& point) {
  const glm::dvec3 v = glm::transpose(camera.rotation) * (glm::dvec3(point) - camera.position);
  return {v.z,
          {camera.fx * v.x / v.z + camera.cx, camera.fy * v.y / v.z + camera.cy},
          {camera.width, camera.height}};
}

/// The camera at another size: the vertical field of view is kept and pixels stay as square as they were; a
/// principal point off the centre stays off by the same angle.
Camera resized(const Camera& camera, int width, int height);

/// A camera at `eye` that looks at `at`; `up` is what should appear upwards in the picture; `fov_degrees` is
/// the vertical field of view. Throws Error if the three do not make a frame.
Camera look_at(const glm::dvec3& eye, const glm::dvec3& at, const glm::dvec3& up, double fov_degrees,
               int width, int height);

}  // namespace binosplat
