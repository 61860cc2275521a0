#pragma once
// The colours along fixed rays while a camera turns in place. They should not change.

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <span>
#include <vector>

#include "render/frame.h"
#include "scene/camera.h"

namespace binosplat::test {

/// Returns the camera turned in place by `radians` about `axis`, a unit vector in the camera's axes.
inline Camera turned(const Camera& camera, const glm::dvec3& axis, double radians) {
  Camera out = camera;
  out.rotation = camera.rotation * glm::mat3_cast(glm::angleAxis(radians, axis));
  return out;
}

/// Returns the point at which a ray from the camera meets the picture; (0, 0) is the centre of the first
/// pixel. NaN if the ray points backward.
inline glm::dvec2 pixel_of(const Camera& camera, const glm::dvec3& ray) {
  const glm::dvec3 v = glm::transpose(camera.rotation) * ray;
  if (!(v.z > 0.0)) return glm::dvec2(std::numeric_limits<double>::quiet_NaN());
  return {camera.fx * v.x / v.z + camera.cx - 0.5, camera.fy * v.y / v.z + camera.cy - 0.5};
}

inline bool is_inside(const Camera& camera, const glm::dvec2& pixel) {
  return pixel.x >= -0.5 && pixel.y >= -0.5 && pixel.x <= camera.width - 0.5 &&
         pixel.y <= camera.height - 0.5;
}

/// Returns the colours over black at points of the camera's picture, each drawn as a view of one pixel.
/// Points may lie between pixel centres.
inline std::vector<glm::vec3> colours_at(render::Frame& frame, const Camera& camera,
                                         std::span<const glm::dvec2> pixels,
                                         const render::FrameSettings& settings,
                                         double near_plane = near_default) {
  const shared::View whole = make_view(camera, near_plane);
  std::vector<glm::vec3> colours;
  colours.reserve(pixels.size());
  std::vector<shared::View> views;
  for (std::size_t begin = 0; begin < pixels.size(); begin += MAX_VIEWS) {
    views.clear();
    for (const glm::dvec2& pixel :
         pixels.subspan(begin, std::min<std::size_t>(MAX_VIEWS, pixels.size() - begin))) {
      Camera one = camera;
      one.width = one.height = 1;
      one.cx -= pixel.x;
      one.cy -= pixel.y;
      views.push_back(make_view(one, near_plane));
      views.back().slopes = whole.slopes;  // the affine projection clamps as in the whole picture
    }
    frame.draw(views, settings);
    for (const Picture& picture : frame.read_pictures()) colours.emplace_back(picture.colour.front());
  }
  return colours;
}

}  // namespace binosplat::test
