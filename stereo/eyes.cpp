#include "stereo/eyes.h"

#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "base/error.h"

namespace binosplat::stereo {

namespace {

/// The right, up and backward axes of an eye, as columns.
glm::dmat3 axes_of(const glm::dvec4& q) {
  const double length = glm::length(q);
  if (!(length > 0.0) || !std::isfinite(length))
    fail("orientation ({}, {}, {}, {}): expected a quaternion x, y, z, w that is not zero", q.x, q.y, q.z,
         q.w);
  return glm::mat3_cast(glm::dquat(q.w / length, q.x / length, q.y / length, q.z / length));
}

Camera camera_of(const std::string& name, const Eye& eye, const Placement& placement,
                 const glm::ivec2& size) {
  if (size.x < 1 || size.y < 1) fail("{}: a picture of {} x {} px", name, size.x, size.y);
  glm::dmat3 rotation = placement.axes * axes_of(eye.orientation);
  rotation[1] = -rotation[1];
  rotation[2] = -rotation[2];
  const glm::dvec3 position = placement.origin + placement.units_per_metre * (placement.axes * eye.position);
  return camera_from_fov(name, position, rotation, eye.fov, size.x, size.y);
}

}  // namespace

std::vector<shared::View> views_from_xr(std::span<const Eye> eyes, const Placement& placement,
                                        std::span<const glm::ivec2> sizes, double near_plane) {
  constexpr double rounding = 1e-6;
  if (eyes.empty() || eyes.size() != sizes.size()) fail("{} eyes and {} sizes", eyes.size(), sizes.size());
  std::vector<Camera> cameras;
  for (std::size_t k = 0; k < eyes.size(); ++k) {
    const std::string name = fmt::format("views[{}].eye", k);
    Camera& camera = cameras.emplace_back(camera_of(name, eyes[k], placement, sizes[k]));
    const double before = glm::dot(cameras[0].rotation[2], camera.position - cameras[0].position);
    const double reach = placement.units_per_metre * glm::length(eyes[0].position);
    if (eyes[k].orientation == eyes[0].orientation && std::abs(before) <= rounding * reach)
      camera.position -= before * cameras[0].rotation[2];
  }
  return views_of_head(cameras, near_plane);
}

}  // namespace binosplat::stereo
