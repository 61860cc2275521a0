#include "scene/framing.h"

#include <algorithm>
#include <cmath>

#include "base/statistics.h"

namespace binosplat {

namespace {

// Finds the point x nearest to the axes of cameras at p that look along f: sum of (1 - f f^T) (x - p) = 0.
std::optional<Capture::Around> look_at_point(std::span<const Camera> cameras, const glm::dvec3& up) {
  glm::dmat3 across{0.0};
  glm::dvec3 places{0.0};
  for (const Camera& camera : cameras) {
    const glm::dvec3 forward = camera.rotation[2];
    const glm::dmat3 of_one = glm::dmat3(1.0) - glm::outerProduct(forward, forward);
    across += of_one;
    places += of_one * camera.position;
  }
  const double count = static_cast<double>(cameras.size());
  constexpr double parallel = 1e-3;  // the determinant is at most 8/27, with axes in all directions
  if (glm::determinant(across) < parallel * count * count * count) return std::nullopt;
  Capture::Around around{glm::inverse(across) * places};
  std::vector<double> distances, heights, facing;
  for (const Camera& camera : cameras) {
    const glm::dvec3 away = camera.position - around.middle;
    distances.push_back(std::max(glm::length(away), 1e-9));
    heights.push_back(std::asin(std::clamp(glm::dot(away, up) / distances.back(), -1.0, 1.0)));
    facing.push_back(-glm::dot(away, camera.rotation[2]) / distances.back());
  }
  constexpr double half_look_there = 0.866;  // cosine of 30 degrees
  if (!(quantile(facing, 0.5) > half_look_there)) return std::nullopt;
  around.first = cameras[0].position - around.middle;
  around.distance = quantile(distances, 0.5);
  around.elevation = quantile(heights, 0.5);
  return around;
}

}  // namespace

std::optional<Capture> capture_of(std::span<const Camera> cameras, const std::optional<glm::dvec3>& up) {
  if (up && !cameras.empty())
    return Capture{glm::normalize(*up), look_at_point(cameras, glm::normalize(*up))};
  glm::dvec3 sum{0.0};
  for (const Camera& camera : cameras) sum -= camera.rotation[1];
  constexpr double common = 0.3;
  if (cameras.empty() || glm::length(sum) < common * static_cast<double>(cameras.size())) return std::nullopt;
  // People hold cameras level but tilt them up and down. So up is as perpendicular as possible to the right
  // axes r, and otherwise near the mean up. It minimises mean (r . u)^2 + near (u - mean)^2.
  constexpr double near = 0.01;
  glm::dmat3 across(near);
  for (const Camera& camera : cameras)
    across += glm::outerProduct(camera.rotation[0], camera.rotation[0]) / static_cast<double>(cameras.size());
  const glm::dvec3 found = glm::normalize(glm::inverse(across) * sum);
  return Capture{found, look_at_point(cameras, found)};
}

double near_plane_for(const CoredModel& cored) {
  // A framed model starts about one radius from the camera. At a tenth of a radius, the near plane leaves
  // room to come closer.
  return cored.model.near_plane.value_or(std::min(near_default, 0.1 * cored.core.radius));
}

}  // namespace binosplat
