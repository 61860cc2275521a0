#include "preview/navigator.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace binosplat::preview {

Navigator::Navigator(const Camera& camera, const glm::dvec3& up, double distance)
    : camera_(camera), up_(glm::normalize(up)), target_(camera.position + distance * camera.rotation[2]) {}

void Navigator::turn(double right, double up, const glm::dvec3& pivot) {
  // Pitch stops a degree before the poles. If a head is beyond this limit, it may only turn back.
  const double pitch = std::asin(std::clamp(glm::dot(camera_.rotation[2], up_), -1.0, 1.0));
  const double most = std::max(std::abs(pitch), glm::radians(89.0));
  const double allowed = std::clamp(pitch + up, -most, most) - pitch;
  const glm::dmat3 turned =
      glm::mat3_cast(glm::angleAxis(-right, up_) * glm::angleAxis(allowed, camera_.rotation[0]));
  const glm::dvec3 from = camera_.position - pivot, ahead = target_ - pivot;
  camera_.position = pivot + turned * from;
  target_ = pivot + turned * ahead;
  // Rotations accumulate rounding errors: orthogonalise the axes.
  const glm::dvec3 z = glm::normalize(turned * camera_.rotation[2]);
  const glm::dvec3 x =
      glm::normalize(turned * camera_.rotation[0] - z * glm::dot(z, turned * camera_.rotation[0]));
  camera_.rotation = glm::dmat3(x, glm::cross(z, x), z);
}

void Navigator::orbit(double right, double up) { turn(right, up, target_); }

void Navigator::look(double right, double up) { turn(right, up, camera_.position); }

void Navigator::move(double right, double up, double forward, bool walking) {
  glm::dvec3 x = camera_.rotation[0], y = -camera_.rotation[1], z = camera_.rotation[2];
  if (walking) {
    y = up_;
    z = glm::normalize(glm::cross(up_, x));  // horizontal
    x = glm::cross(z, up_);
  }
  const glm::dvec3 by = right * x + up * y + forward * z;
  camera_.position += by;
  target_ += by;
}

void Navigator::dolly(double factor) { camera_.position = target_ + factor * (camera_.position - target_); }

void Navigator::set_fov(double radians) {
  const double factor = std::tan(0.5 * fov()) / std::tan(0.5 * radians);
  camera_.fx *= factor;
  camera_.fy *= factor;
}

double Navigator::fov() const { return 2.0 * std::atan(0.5 * camera_.height / camera_.fy); }

void Navigator::focus(const glm::dvec3& point) {
  const glm::dvec3 v = glm::transpose(camera_.rotation) * (point - camera_.position);
  look(std::atan2(v.x, v.z), std::atan2(-v.y, std::hypot(v.x, v.z)));
  target_ = point;
}

}  // namespace binosplat::preview
