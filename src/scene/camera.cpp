#include "scene/camera.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "shared/limits.h"

namespace binosplat {

void set_vertical_fov(Camera& camera, double degrees) {
  camera.fx = camera.fy = 0.5 * camera.height / std::tan(0.5 * glm::radians(degrees));
  camera.cx = 0.5 * camera.width;
  camera.cy = 0.5 * camera.height;
}

void set_lens(shared::View& view, const Camera& camera) {
  view.lens = glm::vec4(glm::dvec4(camera.fx, camera.fy, camera.cx, camera.cy));
  const double right = camera.width - camera.cx, down = camera.height - camera.cy;
  const double margin_x = CLAMP_MARGIN * camera.width, margin_y = CLAMP_MARGIN * camera.height;
  view.slopes = glm::vec4(glm::dvec4(-(camera.cx + margin_x) / camera.fx, -(camera.cy + margin_y) / camera.fy,
                                     (right + margin_x) / camera.fx, (down + margin_y) / camera.fy));
  const double x = std::max(camera.cx, right) / camera.fx, y = std::max(camera.cy, down) / camera.fy;
  view.centre.w = static_cast<float>(x * x + y * y);
  view.width = static_cast<shared::uint>(camera.width);
  view.height = static_cast<shared::uint>(camera.height);
}

shared::View make_view(const Camera& camera, const glm::vec3& anchor, double near_plane) {
  const glm::dvec3 translation = glm::transpose(camera.rotation) * (glm::dvec3(anchor) - camera.position);
  shared::View view{};
  view.row_x = glm::vec4(glm::dvec4(camera.rotation[0], translation.x));
  view.row_y = glm::vec4(glm::dvec4(camera.rotation[1], translation.y));
  view.row_z = glm::vec4(glm::dvec4(camera.rotation[2], translation.z));
  view.anchor = glm::vec4(anchor, static_cast<float>(near_plane));
  view.eye = glm::vec4(glm::vec3(camera.position - glm::dvec3(anchor)), 0.0f);
  view.centre = view.eye;
  set_lens(view, camera);
  return view;
}

shared::View make_view(const Camera& camera, double near_plane) {
  return make_view(camera, glm::vec3(camera.position), near_plane);
}

Camera resized(const Camera& camera, int width, int height) {
  const double factor = static_cast<double>(height) / camera.height;
  Camera out = camera;
  out.width = width;
  out.height = height;
  out.fx = camera.fx * factor;
  out.fy = camera.fy * factor;
  out.cx = width / 2.0 + (camera.cx - camera.width / 2.0) * factor;
  out.cy = height / 2.0 + (camera.cy - camera.height / 2.0) * factor;
  return out;
}

Camera look_at(const glm::dvec3& eye, const glm::dvec3& at, const glm::dvec3& up, double fov_degrees,
               int width, int height) {
  if (!(fov_degrees > 0.0 && fov_degrees < 180.0))
    fail("`fov` {}: expected degrees between 0 and 180", fov_degrees);
  const glm::dvec3 forward = at - eye;
  const glm::dvec3 right = glm::cross(forward, up);
  // Written so that NaN fails, too.
  if (!(glm::length(right) > 1e-9 * glm::length(forward) * glm::length(up)) ||
      !std::isfinite(glm::length(right))) {
    fail(
        "`eye` ({}, {}, {}), `at` ({}, {}, {}), `up` ({}, {}, {}): the camera must look at another point, "
        "not along up",
        eye.x, eye.y, eye.z, at.x, at.y, at.z, up.x, up.y, up.z);
  }
  Camera camera;
  camera.name = "camera";
  camera.width = width;
  camera.height = height;
  set_vertical_fov(camera, fov_degrees);
  camera.position = eye;
  const glm::dvec3 z = glm::normalize(forward);
  const glm::dvec3 x = glm::normalize(right);
  camera.rotation = glm::dmat3(x, glm::cross(z, x), z);
  return camera;
}

}  // namespace binosplat
