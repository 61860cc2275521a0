#include "preview/marks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/statistics.h"
#include "scene/axes.h"
#include "scene/ground.h"

namespace binosplat::preview {

namespace {

constexpr double eyes_above_ground = 1.6, camera_metres = 0.2, above_floor = 0.05;  // m
/// Limits for the number of lines on each side of the grid's middle.
constexpr double min_line_spacing = 2.0, max_line_spacing = 40.0;

/// A metre, or the round number of metres (1, 2 or 5 times a power of ten) that gives about 20 lines.
double spacing_for(double reach, double metre) {
  const double metres = reach / metre;
  if (metres >= min_line_spacing && metres <= max_line_spacing) return metre;
  return metre * round_up(metres / 20.0);
}

}  // namespace

MarkGround find_mark_ground(const Model& model, const glm::dvec3& up) {
  MarkGround found{.up = glm::normalize(up)};
  if (model.count() == 0) return found;
  const CoredModel cored(model);
  found.middle = into_world(cored.core.middle, model.axes);
  found.radius = cored.core.radius;
  if (const auto ground = find_ground(cored, found.up)) found.floor = ground->height;
  return found;
}

MarkPlaces places_of(const MarkGround& ground, std::span<const Camera> cameras, double units_per_metre) {
  const glm::dvec3& up = ground.up;
  const double radius = ground.radius;
  MarkPlaces places{.up = up, .reach = 3.0 * radius};
  places.spacing = spacing_for(places.reach, units_per_metre);
  // Sizes are in metres, but clamped relative to the model, since its units may be wrong.
  const auto length = [&](double metres, double least, double most) {
    return std::clamp(metres * units_per_metre, least * radius, most * radius);
  };
  places.camera_size = length(camera_metres, 0.02, 0.12);
  double height = 0.0;
  if (ground.floor) {
    height = *ground.floor + length(above_floor, 0.002, 0.05);
  } else {
    std::vector<double> heights;
    for (const Camera& camera : cameras) heights.push_back(glm::dot(camera.position, up));
    if (heights.empty()) heights.push_back(glm::dot(ground.middle, up));
    height = quantile(std::move(heights), 0.5) - length(eyes_above_ground, 0.2, 2.0);
  }
  // Lines pass through multiples of the spacing from the world's origin.
  places.middle = height * up;
  for (const glm::dvec3& axis : level_directions(up))
    places.middle += std::round(glm::dot(ground.middle, axis) / places.spacing) * places.spacing * axis;
  return places;
}

std::vector<Line> grid_lines(const MarkPlaces& places) {
  const auto [a, b] = level_directions(places.up);
  const int count = std::max(1, static_cast<int>(std::round(places.reach / places.spacing)));
  const double end = count * places.spacing;
  std::vector<Line> lines;
  for (int k = -count; k <= count; ++k) {
    const double at = k * places.spacing;
    lines.push_back({places.middle + at * a - end * b, places.middle + at * a + end * b, grid_colour});
    lines.push_back({places.middle + at * b - end * a, places.middle + at * b + end * a, grid_colour});
  }
  return lines;
}

std::vector<Line> camera_lines(std::span<const Camera> cameras, std::size_t here, const glm::dvec3& head,
                               double size) {
  std::vector<Line> lines;
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    const Camera& camera = cameras[k];
    if (glm::distance(camera.position, head) < 1.5 * size) continue;
    const glm::vec3& colour = k == here ? camera_here_colour : camera_colour;
    // The field of view sets the width, which is limited for panoramas and wide lenses.
    const glm::dvec2 half =
        size *
        glm::min(0.5 * glm::dvec2(camera.width, camera.height) / glm::dvec2(camera.fx, camera.fy), 1.0);
    const auto at = [&](double x, double y) {
      return camera.position + camera.rotation * glm::dvec3(x * half.x, y * half.y, size);
    };
    const std::array corners = {at(-1, -1), at(1, -1), at(1, 1), at(-1, 1)};
    for (std::size_t c = 0; c < 4; ++c) {
      lines.push_back({camera.position, corners[c], colour});
      lines.push_back({corners[c], corners[(c + 1) % 4], colour});
    }
    lines.push_back({corners[0], at(0, -1.6), colour});
    lines.push_back({at(0, -1.6), corners[1], colour});
  }
  return lines;
}

std::vector<Line> ruler_lines(std::span<const glm::dvec3> points, const glm::dvec3& head) {
  std::vector<Line> lines;
  std::vector<glm::dvec3> ends;
  for (const glm::dvec3& point : points) {
    ends.push_back(glm::mix(point, head, 0.01));
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 arm(0.0);
      arm[axis] = 0.01 * glm::distance(point, head);
      lines.push_back({ends.back() - arm, ends.back() + arm, ruler_colour});
    }
  }
  if (ends.size() == 2) lines.push_back({ends[0], ends[1], ruler_colour});
  return lines;
}

std::vector<MarkVertex> triangles(std::span<const Line> lines, const Camera& eye, double near_plane,
                                  double px) {
  const glm::dvec2 size(eye.width, eye.height);
  const glm::dvec2 scale = glm::dvec2(2.0 * eye.fx, -2.0 * eye.fy) / size;
  const glm::dvec2 shift = glm::dvec2(2.0 * eye.cx, -2.0 * eye.cy) / size + glm::dvec2(-1.0, 1.0);
  const auto clip = [&](const glm::dvec3& p) {
    return glm::dvec4(scale * glm::dvec2(p) + shift * p.z, p.z - 2.0 * near_plane, p.z);
  };
  std::vector<MarkVertex> found;
  found.reserve(6 * lines.size());
  for (const Line& line : lines) {
    glm::dvec3 a = glm::transpose(eye.rotation) * (line.from - eye.position);
    glm::dvec3 b = glm::transpose(eye.rotation) * (line.to - eye.position);
    if (a.z > b.z) std::swap(a, b);
    if (b.z <= near_plane) continue;
    if (a.z < near_plane) a = glm::mix(a, b, (near_plane - a.z) / (b.z - a.z));
    const glm::dvec4 from = clip(a), to = clip(b);
    const glm::dvec2 along = (glm::dvec2(to) / to.w - glm::dvec2(from) / from.w) * size;  // in half px
    const double length = glm::length(along);
    if (!(length > 0.0)) continue;
    const glm::dvec2 aside = px * glm::dvec2(-along.y, along.x) / length / size;
    const auto corner = [&](const glm::dvec4& end, double side) {
      const glm::dvec4 moved = end + glm::dvec4(side * end.w * aside, 0.0, 0.0);
      return MarkVertex{glm::vec4(moved), glm::vec4(line.colour, 1.0f)};
    };
    const std::array corners = {corner(from, -1), corner(from, 1), corner(to, -1), corner(to, 1)};
    for (const std::size_t c : {0, 1, 2, 2, 1, 3}) found.push_back(corners[c]);
  }
  return found;
}

}  // namespace binosplat::preview
