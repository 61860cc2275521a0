#include "stereo/comfort.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace binosplat::stereo {

namespace {

// Projects a world point into a camera's picture, px.
glm::dvec2 projected(const Camera& camera, const glm::dvec3& point) {
  const glm::dvec3 v = glm::transpose(camera.rotation) * (point - camera.position);
  return {camera.fx * v.x / v.z + camera.cx, camera.fy * v.y / v.z + camera.cy};
}

struct Sample {
  double px;
  double degrees;
  double vertical_px;
};

// The angle at a point between the lines to both eyes, in degrees.
double angle_at(const std::array<Camera, 2>& eyes, const glm::dvec3& point) {
  const glm::dvec3 a = point - eyes[0].position, b = point - eyes[1].position;
  return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

Sample sample_at(const std::array<Camera, 2>& eyes, const glm::dvec2& pixel, double z,
                 std::optional<double> focus) {
  const Camera& left = eyes[0];
  const glm::dvec3 ray = ray_through(left, pixel);
  const glm::dvec3 point = left.position + z * ray;
  const glm::dvec2 seen = projected(eyes[1], point);
  // The point and the focus lie on one ray of the left eye, so only their pixels in the right eye differ. An
  // infinitely far focus has the same direction from both eyes.
  const glm::dvec3 focused = (focus ? left.position : eyes[1].position) + focus.value_or(1.0) * ray;
  const double at_focus = focus ? angle_at(eyes, focused) : 0.0;
  const double px = projected(eyes[1], focused).x - seen.x;
  return {px, angle_at(eyes, point) - at_focus, std::abs(pixel.y - seen.y)};
}

double quantile_of(std::vector<double>& values, double share) {
  const auto middle =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::optional<double> screen_distance(const std::array<Camera, 2>& eyes) {
  const double shift = eyes[1].cx - eyes[0].cx;
  if (!(shift > 0.0)) return std::nullopt;
  return eyes[0].fx * glm::length(eyes[1].position - eyes[0].position) / shift;
}

std::optional<DisparityRange> disparity_range(const std::array<Camera, 2>& eyes, const Picture& left,
                                              std::optional<double> focus) {
  constexpr double left_out = 0.01;
  const Image depth = depth_map(left);
  std::vector<double> px, degrees;
  DisparityRange range;
  // Sixty thousand pixels of a large picture are enough.
  const int step = std::max(1, static_cast<int>(std::sqrt(left.width * (left.height / 60e3))));
  for (int y = 0; y < left.height; y += step) {
    for (int x = 0; x < left.width; x += step) {
      const double z = depth.at(x, y, 0);
      if (!std::isfinite(z) || z <= 0.0) continue;
      const Sample sample = sample_at(eyes, {x + 0.5, y + 0.5}, z, focus);
      if (!std::isfinite(sample.px)) continue;  // outside the right eye's view
      px.push_back(sample.px);
      degrees.push_back(sample.degrees);
      range.vertical_px = std::max(range.vertical_px, sample.vertical_px);
    }
  }
  if (px.empty()) return std::nullopt;
  range.near_px = quantile_of(px, 1.0 - left_out);
  range.middle_px = quantile_of(px, 0.5);
  range.far_px = quantile_of(px, left_out);
  range.near_degrees = quantile_of(degrees, 1.0 - left_out);
  range.far_degrees = quantile_of(degrees, left_out);
  return range;
}

bool is_comfortable(const DisparityRange& range) {
  return range.near_degrees <= comfortable_degrees && range.far_degrees >= -comfortable_degrees;
}

ComfortableRig comfortable_rig(const DisparityRange& range, const std::array<Camera, 2>& eyes) {
  // For parallel eyes a disparity in px is fx ipd (1/z - 1/D). For a point straight ahead, disparity / fx is
  // about the angle in radians; for points at the sides, the angle is smaller.
  const double ipd = glm::length(eyes[1].position - eyes[0].position);
  const auto screen = screen_distance(eyes);
  const double middle = 0.5 * (range.near_px + range.far_px) / (eyes[0].fx * ipd);
  ComfortableRig rig;
  rig.convergence = 1.0 / (middle + (screen ? 1.0 / *screen : 0.0));
  const double spread = glm::degrees((range.near_px - range.far_px) / eyes[0].fx);
  if (spread > 2.0 * comfortable_degrees) rig.ipd = ipd * 1.98 * comfortable_degrees / spread;
  return rig;
}

ComfortableRig comfortable_rig(double nearest, double farthest, double ipd) {
  const double near = 1.0 / nearest, far = 1.0 / farthest;
  const double most = 2.0 * glm::radians(0.85 * comfortable_degrees) / std::max(near - far, 1e-3 * near);
  return {2.0 / (near + far), std::min(ipd, most)};
}

std::optional<double> suitable_convergence(const std::array<Camera, 2>& eyes, const Picture& left,
                                           double units_per_metre) {
  const auto screen = screen_distance(eyes);
  const auto range = disparity_range(eyes, left, screen);
  if (!range) return std::nullopt;
  // Slightly below the limit, because angles at the sides differ.
  const double reach = eyes[0].fx * glm::radians(0.99 * comfortable_degrees);
  const auto [least, most] = std::minmax({range->near_px - reach, range->far_px + reach});
  const double px = std::clamp(range->middle_px, least, most);
  const double ipd = glm::length(eyes[1].position - eyes[0].position);
  const double inverse = px / (eyes[0].fx * ipd) + (screen ? 1.0 / *screen : 0.0);
  const double metres = 1.0 / (inverse * units_per_metre);
  if (!(metres > 0.0 && std::isfinite(metres))) return std::nullopt;
  const double digit = std::pow(10.0, std::floor(std::log10(metres)) - 2.0);
  return std::round(metres / digit) * digit;
}

}  // namespace binosplat::stereo
