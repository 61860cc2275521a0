#include "measure/turn_stability.h"

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <limits>

namespace binosplat::measure {

Camera turned(const Camera& camera, const glm::dvec3& axis, double radians) {
  Camera out = camera;
  out.rotation = camera.rotation * glm::mat3_cast(glm::angleAxis(radians, axis));
  return out;
}

glm::dvec2 pixel_of(const Camera& camera, const glm::dvec3& ray) {
  const glm::dvec3 v = glm::transpose(camera.rotation) * ray;
  if (!(v.z > 0.0)) return glm::dvec2(std::numeric_limits<double>::quiet_NaN());
  return {camera.fx * v.x / v.z + camera.cx - 0.5, camera.fy * v.y / v.z + camera.cy - 0.5};
}

bool is_inside(const Camera& camera, const glm::dvec2& pixel) {
  return pixel.x >= -0.5 && pixel.y >= -0.5 && pixel.x <= camera.width - 0.5 &&
         pixel.y <= camera.height - 0.5;
}

std::vector<glm::vec3> colours_at(render::Frame& frame, const Camera& camera,
                                  std::span<const glm::dvec2> pixels, const render::FrameSettings& settings,
                                  double near_plane) {
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

}  // namespace binosplat::measure
