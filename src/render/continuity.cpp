#include "render/continuity.h"

#include <algorithm>
#include <cmath>

namespace binosplat::render {

namespace {

constexpr double turn_max_degrees = 15.0;
constexpr double move_max_of_depth = 0.1;

double turned_degrees(const shared::View& a, const shared::View& b) {
  const auto dot = [](const glm::vec4& x, const glm::vec4& y) {
    return glm::dot(glm::dvec3(x), glm::dvec3(y));
  };
  // The trace of the rotation from one to the other is 1 + 2 cos(angle).
  const double trace = dot(a.row_x, b.row_x) + dot(a.row_y, b.row_y) + dot(a.row_z, b.row_z);
  return glm::degrees(std::acos(std::clamp((trace - 1.0) / 2.0, -1.0, 1.0)));
}

double moved(const shared::View& a, const shared::View& b) {
  const glm::dvec3 eye_a = glm::dvec3(a.anchor) + glm::dvec3(a.eye);
  const glm::dvec3 eye_b = glm::dvec3(b.anchor) + glm::dvec3(b.eye);
  return glm::length(eye_a - eye_b);
}

}  // namespace

bool continues(const FrameShape& before, const FrameShape& now, double median_depth, double share) {
  if (before.asked != now.asked || before.gaussian_count != now.gaussian_count) return false;
  for (std::size_t v = 0; v < now.asked; ++v) {
    const shared::View& a = before.views[v];
    const shared::View& b = now.views[v];
    if (a.width != b.width || a.height != b.height || a.lens != b.lens) return false;
    if (turned_degrees(a, b) > share * turn_max_degrees ||
        moved(a, b) > share * move_max_of_depth * median_depth)
      return false;
  }
  return true;
}

bool remembers(const FrameShape& before, const FrameShape& now, double median_depth) {
  return measures(before.settings.transmittance) && measures(now.settings.transmittance) &&
         before.settings.decode == now.settings.decode && continues(before, now, median_depth);
}

}  // namespace binosplat::render
