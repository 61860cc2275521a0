#include "demo/shapes.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace binosplat::demo {

namespace {

/// Discs a cell apart overlap enough to close the surface when their standard deviation is this share of the
/// cell: at an opacity of 0.97 the corner between four of them is covered by 99 %.
constexpr double room_overlap = 0.74;
/// A sheet's outermost discs lie this many cells inside its border: half transparent just there.
constexpr double margin_at_border = 1.1 * room_overlap;
/// Thickness of a disc as a share of its smaller side.
constexpr double room_flatness = 0.08;

/// A row of discs of about this grain.
struct Row : Cells {
  int count;
  Row(double length, double grain, double margin)
      : Row(length, margin, std::max(1, static_cast<int>(std::lround(length / grain - 2.0 * margin + 1.0)))) {
  }

 private:
  Row(double length, double margin, int discs)
      : Cells(length, static_cast<std::uint32_t>(discs), margin, margin), count(discs) {}
};

/// Lengths of a polyline from its start to each point.
template <typename Point>
std::vector<double> lengths(const std::vector<Point>& points) {
  std::vector<double> sums{0.0};
  for (std::size_t i = 1; i < points.size(); ++i)
    sums.push_back(sums.back() + glm::length(points[i] - points[i - 1]));
  return sums;
}

}  // namespace

double hash(std::int64_t a, std::int64_t b) {
  const std::uint64_t mixed = scramble(static_cast<std::uint64_t>(a) * 0x9e3779b97f4a7c15ull + 1);
  return static_cast<double>(scramble(mixed ^ static_cast<std::uint64_t>(b)) >> 11) * 0x1p-53;
}

double noise(double x, double y) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto i = static_cast<std::int64_t>(fx), j = static_cast<std::int64_t>(fy);
  const double u = ramp(0.0, 1.0, x - fx), v = ramp(0.0, 1.0, y - fy);
  const double above = hash(i, j) * (1.0 - u) + hash(i + 1, j) * u;
  const double below = hash(i, j + 1) * (1.0 - u) + hash(i + 1, j + 1) * u;
  return above * (1.0 - v) + below * v;
}

double fractal(double x, double y) {
  double sum = 0.0, weight = 0.5;
  for (int octave = 0; octave < 4; ++octave) {
    sum += weight * noise(x, y);
    weight *= 0.5;
    x = 2.0 * x + 17.3;
    y = 2.0 * y + 9.7;
  }
  return sum / 0.9375;
}

dvec3 mix(const dvec3& a, const dvec3& b, double t) { return a + (b - a) * t; }

double ramp(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

Frame turned(const dvec3& origin, double degrees) {
  const double c = std::cos(glm::radians(degrees)), s = std::sin(glm::radians(degrees));
  return {origin, dmat3(dvec3(c, 0, s), dvec3(0, 1, 0), dvec3(-s, 0, c))};
}

Frame rolled(const Frame& frame, double degrees) {
  const double c = std::cos(glm::radians(degrees)), s = std::sin(glm::radians(degrees));
  return {frame.origin, frame.axes * dmat3(dvec3(c, s, 0), dvec3(-s, c, 0), dvec3(0, 0, 1))};
}

dmat3 axes_from_normal(const dvec3& normal, const dvec3& along) {
  const dvec3 tangent = glm::normalize(along - normal * glm::dot(normal, along));
  return dmat3(tangent, glm::cross(normal, tangent), normal);
}

glm::vec4 quaternion(const dmat3& axes) {
  const glm::dquat q = glm::normalize(glm::quat_cast(axes));
  return {q.w, q.x, q.y, q.z};
}

std::vector<dvec3> curve(const std::vector<dvec3>& points, double step) {
  std::vector<dvec3> out;
  const std::size_t n = points.size();
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const dvec3 a = points[i == 0 ? 0 : i - 1], b = points[i], c = points[i + 1],
                d = points[std::min(i + 2, n - 1)];
    const int pieces = std::max(1, static_cast<int>(std::lround(glm::length(c - b) / step)));
    for (int k = 0; k < pieces; ++k) {
      const double t = static_cast<double>(k) / pieces;
      out.push_back(0.5 * (2.0 * b + t * (c - a) + t * t * (2.0 * a - 5.0 * b + 4.0 * c - d) +
                           t * t * t * (3.0 * b - a - 3.0 * c + d)));
    }
  }
  out.push_back(points.back());
  return out;
}

void Stage::disc(const dvec3& position, const dmat3& axes, const dvec3& scale, const Material& material) {
  if (material.opacity > 0.0) discs.push_back({position, axes, scale, material});
}

void Stage::sheet(const dvec3& corner, const dvec3& edge_u, const dvec3& edge_v, Grain grain,
                  const Texture& texture) {
  const double length_u = glm::length(edge_u), length_v = glm::length(edge_v);
  const dvec3 u = edge_u / length_u, v = edge_v / length_v;
  const dmat3 axes = axes_from_normal(glm::normalize(glm::cross(u, v)), u);
  const double margin = grain.border == Border::ends ? margin_at_border : 0.5;
  const Row row_u(length_u, grain.u, margin), row_v(length_v, grain.v, margin);
  const double su = room_overlap * row_u.size, sv = room_overlap * row_v.size;
  for (int j = 0; j < row_v.count; ++j) {
    for (int i = 0; i < row_u.count; ++i) {
      const double a = row_u.first + i * row_u.size, b = row_v.first + j * row_v.size;
      disc(corner + a * u + b * v, axes, {su, sv, room_flatness * std::min(su, sv)}, texture(a, b));
    }
  }
}

void Stage::box(const Frame& frame, const dvec3& low, const dvec3& high, Grain grain,
                const Texture& texture) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool far_side : {false, true}) {
      const double place = far_side ? high[axis] : low[axis];
      if (axis == 1 && place == 0.0) continue;
      int a = (axis + 1) % 3, b = (axis + 2) % 3;  // cross(e_a, e_b) = e_axis
      if (high[b] - low[b] > high[a] - low[a]) std::swap(a, b);
      dvec3 corner = low, edge_u(0.0), edge_v(0.0);
      corner[axis] = place;
      edge_u[a] = high[a] - low[a];
      edge_v[b] = high[b] - low[b];
      if ((glm::cross(edge_u, edge_v)[axis] > 0.0) != far_side) {  // turn the front outwards
        corner += edge_v;
        edge_v = -edge_v;
      }
      sheet(frame.at(corner.x, corner.y, corner.z), frame.axes * edge_u, frame.axes * edge_v, grain, texture);
    }
  }
}

void Stage::solid_box(const Frame& frame, const dvec3& low, const dvec3& high, Grain grain,
                      const Texture& texture) {
  box(frame, low, high, grain, texture);
  block(Solid::Shape::box, frame, low, high);
}

void Stage::ellipsoid(const Frame& frame, const dvec3& radii, double grain, const Texture& texture) {
  const double mean = std::cbrt(radii.x * radii.y * radii.z);
  const int count = std::max(12, static_cast<int>(std::lround(4.0 * pi * mean * mean / (grain * grain))));
  const double sigma = room_overlap * std::sqrt(4.0 * pi / count);  // on the unit sphere
  const double golden = pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {  // a Fibonacci spiral from pole to pole
    const double y = 1.0 - 2.0 * (i + 0.5) / count, ring = std::sqrt(1.0 - y * y);
    const double longitude = golden * i;
    const dvec3 p(ring * std::cos(longitude), y, ring * std::sin(longitude));
    const Material material = texture(std::remainder(longitude, 2.0 * pi), std::asin(y));
    const dvec3 normal = glm::normalize(frame.axes * (p / radii));
    const dmat3 axes = axes_from_normal(normal, frame.axes * dvec3(-p.z, 0.0, p.x));
    dvec3 scale(0.0);
    for (int k = 0; k < 2; ++k) {  // a tangent step on the sphere becomes this long on the ellipsoid
      const dvec3 local = glm::transpose(frame.axes) * axes[k];
      scale[k] = sigma / glm::length(local / radii);
    }
    scale.z = room_flatness * std::min(scale.x, scale.y);
    // Half the disc's sagitta inwards, so that the silhouette keeps the radius.
    disc(frame.at(p.x * radii.x, p.y * radii.y, p.z * radii.z) - 0.5 * sigma * sigma * mean * normal, axes,
         scale, material);
  }
}

void Stage::lathe(const Frame& frame, const std::vector<dvec2>& profile, double grain,
                  const Texture& texture) {
  // Each stretch between sharp corners is a surface of its own, which ends at them.
  double done = 0.0;
  std::size_t from = 0;
  for (std::size_t k = 1; k < profile.size(); ++k) {
    if (k + 1 < profile.size()) {
      const dvec2 a = glm::normalize(profile[k] - profile[k - 1]),
                  b = glm::normalize(profile[k + 1] - profile[k]);
      if (glm::dot(a, b) > 0.6) continue;
    }
    const std::vector<dvec2> stretch(profile.begin() + static_cast<std::ptrdiff_t>(from),
                                     profile.begin() + static_cast<std::ptrdiff_t>(k + 1));
    done += smooth_lathe(frame, stretch, grain, texture, done);
    from = k;
  }
}

double Stage::smooth_lathe(const Frame& frame, const std::vector<dvec2>& profile, double grain,
                           const Texture& texture, double done) {
  const std::vector<double> way = lengths(profile);
  const Row row(way.back(), grain, margin_at_border);
  for (int j = 0; j < row.count; ++j) {
    const double v = row.first + j * row.size;
    std::size_t k = 1;
    while (k + 1 < profile.size() && way[k] < v) ++k;
    const double t = (v - way[k - 1]) / std::max(way[k] - way[k - 1], 1e-9);
    const dvec2 at = profile[k - 1] + t * (profile[k] - profile[k - 1]);
    const dvec2 along = glm::normalize(profile[k] - profile[k - 1]);
    const double round = 2.0 * pi * at.x;
    const int count = std::max(3, static_cast<int>(std::lround(round / grain)));
    const double su = room_overlap * round / count, sv = room_overlap * row.size;
    for (int i = 0; i < count; ++i) {
      const double angle = 2.0 * pi * (i + 0.5 * (j % 2)) / count;
      const Material material = texture(angle, done + v);
      const dvec3 outwards(std::cos(angle), 0.0, std::sin(angle));
      const dvec3 normal = frame.axes * (along.y * outwards - dvec3(0.0, along.x, 0.0));
      const dvec3 around = frame.axes * dvec3(-outwards.z, 0.0, outwards.x);
      const dvec3 p = frame.origin + frame.axes * (at.x * outwards + dvec3(0.0, at.y, 0.0));
      disc(p, axes_from_normal(normal, around), {su, sv, room_flatness * std::min(su, sv)}, material);
    }
  }
  return way.back();
}

void Stage::tube(const std::vector<dvec3>& path, double radius, double grain, const Texture& texture) {
  const std::vector<double> way = lengths(path);
  const int around = std::max(5, static_cast<int>(std::lround(2.0 * pi * radius / grain)));
  dvec3 side(0.3, 0.2, 1.0);  // carried along the path, so that the rings do not twist
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const double length = way[i + 1] - way[i];
    const dvec3 forward = (path[i + 1] - path[i]) / length;
    side = glm::normalize(side - forward * glm::dot(forward, side));
    const dvec3 up = glm::cross(forward, side);
    for (int k = 0; k < around; ++k) {
      const double angle = 2.0 * pi * (k + 0.5 * static_cast<double>(i % 2)) / around;
      const Material material = texture(angle, way[i] + 0.5 * length);
      const dvec3 normal = std::cos(angle) * side + std::sin(angle) * up;
      const double su = room_overlap * length, sv = room_overlap * 2.0 * pi * radius / around;
      disc(0.5 * (path[i] + path[i + 1]) + 0.9 * radius * normal, axes_from_normal(normal, forward),
           {su, sv, room_flatness * std::min(su, sv)}, material);
    }
  }
}

void Stage::wire(const std::vector<dvec3>& path, double radius, double grain, const Material& material) {
  const double length = lengths(path).back();
  const int count = std::max(1, static_cast<int>(std::lround(length / grain)));
  std::size_t k = 1;
  double start = 0.0;  // the way to point k - 1
  for (int i = 0; i < count; ++i) {
    const double at = (i + 0.5) * length / count;
    while (k + 1 < path.size() && start + glm::length(path[k] - path[k - 1]) < at) {
      start += glm::length(path[k] - path[k - 1]);
      ++k;
    }
    const dvec3 forward = glm::normalize(path[k] - path[k - 1]);
    // A wire has no front: its normal is as near to upwards as it can be, which is right for light from
    // above.
    const dvec3 upwards = std::abs(forward.y) < 0.95 ? dvec3(0, -1, 0) : dvec3(0, 0, -1);
    const dvec3 normal = glm::normalize(upwards - forward * glm::dot(forward, upwards));
    const double thin = 0.6 * radius;
    disc(path[k - 1] + (at - start) * forward, axes_from_normal(normal, forward),
         {room_overlap * length / count, thin, thin}, material);
  }
}

void Stage::block(Solid::Shape shape, const Frame& frame, const dvec3& low, const dvec3& high) {
  if (solids.empty()) group();
  SolidGroup& last = solids.back();
  const dvec3 middle = 0.5 * (low + high);
  const dvec3 centre = frame.at(middle.x, middle.y, middle.z);
  const double radius = 0.5 * glm::length(high - low);
  if (last.solids.empty()) {
    last.centre = centre;
    last.radius = radius;
  } else {
    last.radius = std::max(last.radius, glm::length(centre - last.centre) + radius);
  }
  const dmat3 to_unit = dmat3(dvec3(2.0 / (high.x - low.x), 0, 0), dvec3(0, 2.0 / (high.y - low.y), 0),
                              dvec3(0, 0, 2.0 / (high.z - low.z))) *
                        glm::transpose(frame.axes);
  last.solids.push_back({shape, to_unit, -(to_unit * centre), centre, radius});
}

void Stage::remove_hidden() {
  constexpr double skin = 0.003;  // a box's own faces stay
  const auto hidden = [&](const Disc& disc) {
    for (const SolidGroup& group : solids) {
      if (glm::length(disc.position - group.centre) > group.radius) continue;
      for (const Solid& solid : group.solids) {
        if (solid.shape != Solid::Shape::box) continue;
        const dvec3 p = glm::abs(solid.to_unit * disc.position + solid.unit_origin);
        bool inside = true;
        for (int i = 0; i < 3; ++i) {
          const dvec3 row(solid.to_unit[0][i], solid.to_unit[1][i], solid.to_unit[2][i]);
          inside = inside && p[i] < 1.0 - skin * glm::length(row);
        }
        if (inside) return true;
      }
    }
    return false;
  };
  std::erase_if(discs, hidden);
}

}  // namespace binosplat::demo
