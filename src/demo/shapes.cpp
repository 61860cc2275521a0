#include "demo/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/random.h"

namespace binosplat::demo {

namespace {

/// Standard deviation of a Gaussian, relative to the cell. Gaussians a cell apart then close a surface: at an
/// opacity of 0.97, they cover the corner between four of them by 99 %.
constexpr double overlap = 0.76;
/// A sheet's outermost Gaussians are this many cells inside its border, where they are half transparent.
constexpr double margin_at_border = 0.83;
/// Thickness of a Gaussian, relative to its smaller side, and at most in m: far ground must not become fog.
constexpr double flatness = 0.08, thickest = 0.25;
/// A sheet is split until its grain varies by less than this factor, or its longer side has so few grains.
constexpr double grain_varies = 1.5, piece_grains = 4.0;
/// Area of the leaves of a crown of radius 1.
constexpr double crown_area = 22.0;

/// Places `count` Gaussians along a length: the first lies `first` from its start, the others a cell apart.
/// At a border where the surface continues, the outermost Gaussian is half a cell inside.
struct Cells {
  double first, size;
  Cells(double length, std::uint64_t count, bool low_ends, bool high_ends) {
    const double low = low_ends ? margin_at_border : 0.5, high = high_ends ? margin_at_border : 0.5;
    size = length / (static_cast<double>(count) - 1.0 + low + high);
    first = low * size;
  }
};

dvec3 flat(double along_u, double along_v) {
  const double u = overlap * along_u, v = overlap * along_v;
  return {u, v, std::min(thickest, flatness * std::min(u, v))};
}

/// Returns points of a smooth curve (Catmull-Rom) through `points`, about `step` apart.
std::vector<dvec3> curve(const std::vector<dvec3>& points, double step) {
  std::vector<dvec3> out;
  const std::size_t n = points.size();
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const dvec3 b = points[i], c = points[i + 1];
    const dvec3 a = i == 0 ? 2.0 * b - c : points[i - 1], d = i + 2 == n ? 2.0 * c - b : points[i + 2];
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

/// Returns the length of a polyline up to each point.
template <typename Point>
std::vector<double> lengths(const std::vector<Point>& points) {
  std::vector<double> sums{0.0};
  for (std::size_t i = 1; i < points.size(); ++i)
    sums.push_back(sums.back() + glm::length(points[i] - points[i - 1]));
  return sums;
}

/// Returns the material of a cell with its mean colour; larger cells are sampled at more points.
Material mean_material(const Surface& surface, const dvec2& middle, const dvec2& extent) {
  const double size = std::max(extent.x, extent.y);
  const int n = size < 0.05 ? 1 : size < 1.0 ? 2 : 3;
  Material mean = surface.texture(middle.x, middle.y);
  if (n == 1) return mean;
  mean.colour = dvec3(0.0);
  for (int k = 0; k < n * n; ++k) {
    const dvec2 p =
        middle + dvec2((k % n + 0.5) / n - 0.5, (std::floor(double(k) / n) + 0.5) / n - 0.5) * extent;
    mean.colour += surface.texture(p.x, p.y).colour / double(n * n);
  }
  return mean;
}

void make_sheet(const Surface& s, const std::function<void(const Disc&)>& add) {
  const double length_u = glm::length(s.u), length_v = glm::length(s.v);
  const dvec3 u = s.u / length_u, v = s.v / length_v;
  const dmat3 axes = axes_from_normal(glm::normalize(glm::cross(u, v)), u);
  const std::uint64_t n = s.count;
  const double even = std::sqrt(static_cast<double>(n) * length_v * s.grain.u / (length_u * s.grain.v));
  const auto rows = std::clamp<std::uint64_t>(static_cast<std::uint64_t>(std::llround(even)), 1, n);
  const Cells high(length_v, rows, (s.borders & border_low) != 0, (s.borders & border_high) != 0);
  for (std::uint64_t j = 0; j < rows; ++j) {
    const std::uint64_t in_row = (j + 1) * n / rows - j * n / rows;
    const Cells wide(length_u, in_row, (s.borders & border_left) != 0, (s.borders & border_right) != 0);
    const dvec3 scale = flat(wide.size, high.size);
    const double b = high.first + static_cast<double>(j) * high.size;
    for (std::uint64_t i = 0; i < in_row; ++i) {
      const double a = wide.first + static_cast<double>(i) * wide.size;
      add({s.corner + a * u + b * v, axes, scale,
           mean_material(s, s.at + dvec2(a, b), {wide.size, high.size})});
    }
  }
}

dvec3 in_ball(Random& random) {
  while (true) {
    dvec3 p;
    for (int k = 0; k < 3; ++k) p[k] = random.uniform(-1.0, 1.0);
    const double square = glm::dot(p, p);
    if (square > 0.01 && square <= 1.0) return p;
  }
}

void make_crown(const Surface& s, const std::function<void(const Disc&)>& add) {
  constexpr std::uint32_t lumps = 11;
  constexpr double lump_radius = 0.50;  // of the crown's radius
  std::array<dvec3, lumps> middles;
  Random of_crown(std::uint64_t{s.seed} * 77 + 5);
  for (std::uint32_t k = 0; k < lumps; ++k)
    middles[k] = glm::normalize(in_ball(of_crown)) * (k == 0 ? 0.0 : 1.0 - lump_radius);
  const double size = std::min(0.5 * s.u.x, 0.62 * s.u.x * std::sqrt(crown_area / s.count));
  for (std::uint32_t i = 0; i < s.count; ++i) {
    Random random((std::uint64_t{s.seed} << 32) + i);
    const dvec3 out = glm::normalize(in_ball(random));
    const double deep = std::max(random.uniform(), random.uniform()) * 0.35 + 0.65;
    // If there are fewer Gaussians than lumps, each represents the whole crown.
    const double shell = lump_radius * deep * (1.0 - 0.5 * size / s.u.x);
    const dvec3 place = s.count < lumps ? dvec3(0.0) : middles[i % lumps] + shell * out;
    const dvec3 normal = glm::normalize(0.5 * in_ball(random) + out + place);
    const dvec3 along = in_ball(random);
    Material leaf = s.texture(glm::length(place), glm::dot(place, out));
    leaf.colour *= 0.90 + 0.2 * random.uniform();
    leaf.two_sided = true;
    add({s.corner + place * s.u, axes_from_normal(normal, along), dvec3(1.15, 0.85, 0.45) * size, leaf});
  }
}

}  // namespace

double hash(std::int64_t a, std::int64_t b) {
  const std::uint64_t mixed = scramble(static_cast<std::uint64_t>(a) * 0x9e3779b97f4a7c15ull + 1);
  return static_cast<double>(scramble(mixed ^ static_cast<std::uint64_t>(b)) >> 11) * 0x1p-53;
}

double hash_at(double x, double y) {
  return hash(static_cast<std::int64_t>(std::floor(x)), static_cast<std::int64_t>(std::floor(y)));
}

double noise(double x, double y) {
  const double fx = std::floor(x), fy = std::floor(y), a = x - fx, b = y - fy;
  const auto i = static_cast<std::int64_t>(fx), j = static_cast<std::int64_t>(fy);
  const double u = a * a * (3.0 - 2.0 * a), v = b * b * (3.0 - 2.0 * b);
  const auto between = [&](std::int64_t k) { return hash(i, k) * (1.0 - u) + hash(i + 1, k) * u; };
  return between(j) * (1.0 - v) + between(j + 1) * v;
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

dvec2 circle(double turn) {
  // Series of cosine and sine at a quarter of the angle, which is then doubled twice.
  const double x = 0.5 * pi * (turn - std::floor(turn + 0.5)), s = x * x;
  dvec2 p(1.0 - s / 2.0 * (1.0 - s / 12.0 * (1.0 - s / 30.0 * (1.0 - s / 56.0 * (1.0 - s / 90.0)))),
          x * (1.0 - s / 6.0 * (1.0 - s / 20.0 * (1.0 - s / 42.0 * (1.0 - s / 72.0 * (1.0 - s / 110.0))))));
  for (int k = 0; k < 2; ++k) p = {p.x * p.x - p.y * p.y, 2.0 * p.x * p.y};
  return glm::normalize(p);
}

double part_of(double value, double period) { return value - period * std::floor(value / period); }

LocalAxes turned(const dvec3& origin, double degrees, double roll) {
  const dvec2 t = circle(degrees / 360.0), r = circle(roll / 360.0);
  return {origin, dmat3(dvec3(t.x, 0, t.y), down, dvec3(-t.y, 0, t.x)) *
                      dmat3(dvec3(r.x, r.y, 0), dvec3(-r.y, r.x, 0), away)};
}

dmat3 axes_from_normal(const dvec3& normal, const dvec3& along) {
  const dvec3 tangent = glm::normalize(along - normal * glm::dot(normal, along));
  return dmat3(tangent, glm::cross(normal, tangent), normal);
}

void make_discs(const Surface& surface, const std::function<void(const Disc&)>& add) {
  surface.crown ? make_crown(surface, add) : make_sheet(surface, add);
}

void SceneBuilder::disc(const dvec3& position, const dmat3& axes, const dvec3& scale,
                        const Material& material) {
  discs.push_back({frame.at(position), frame.axes * axes, scale, material});
}

void SceneBuilder::sheet(Surface surface) {
  surface.corner = frame.at(surface.corner);
  surface.u = frame.axes * surface.u;
  surface.v = frame.axes * surface.v;
  add_pieces(surface);
}

void SceneBuilder::add_pieces(const Surface& surface) {
  const double length_u = glm::length(surface.u), length_v = glm::length(surface.v);
  const double coarseness = std::min(surface.grain.u, surface.grain.v);
  const dvec3 middle = surface.corner + 0.5 * (surface.u + surface.v);
  const double here = grain_(middle, coarseness);
  double least = here, most = here;
  for (const dvec2 way : {dvec2(0, 0), dvec2(1, 0), dvec2(0, 1), dvec2(1, 1)}) {
    const double there = grain_(surface.corner + way.x * surface.u + way.y * surface.v, coarseness);
    least = std::min(least, there);
    most = std::max(most, there);
  }
  Surface low = surface, high = surface;
  if (most <= grain_varies * least || std::max(length_u, length_v) <= piece_grains * least) {
    // Strips much narrower than the grain must not become needles.
    const double columns = std::max(length_u / (here * surface.grain.u / coarseness), 1.0),
                 rows = std::max(length_v / (here * surface.grain.v / coarseness), 1.0);
    low.weight = columns * rows;
    low.count = static_cast<std::uint32_t>(std::llround(columns) * std::llround(rows));
    surfaces.push_back(low);
    return;
  }
  if (length_u > length_v) {
    low.u = high.u = 0.5 * surface.u;
    high.corner += low.u;
    high.at.x += 0.5 * length_u;
    low.borders &= ~border_right;
    high.borders &= ~border_left;
  } else {
    low.v = high.v = 0.5 * surface.v;
    high.corner += low.v;
    high.at.y += 0.5 * length_v;
    low.borders &= ~border_high;
    high.borders &= ~border_low;
  }
  add_pieces(low);
  add_pieces(high);
}

void SceneBuilder::box(const dvec3& low, const dvec3& high, Grain grain_of_box, const Texture& texture) {
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
      sheet(corner, edge_u, edge_v, texture, grain_of_box, all_borders);
    }
  }
}

void SceneBuilder::solid_box(const dvec3& low, const dvec3& high, Grain grain_of_box,
                             const Texture& texture) {
  box(low, high, grain_of_box, texture);
  solid(Solid::Shape::box, low, high);
}

void SceneBuilder::crown(const dvec3& middle, double radius, double coarseness, const Texture& leaves,
                         std::uint32_t seed) {
  crowns.add(Solid::Shape::ellipsoid, frame, middle - radius, middle + radius);
  const double size = radius / grain(middle, coarseness);
  if (size < 0.6) return;  // too small to be visible
  Surface ball{
      .corner = frame.at(middle), .u = dvec3(radius), .texture = leaves, .crown = true, .seed = seed};
  ball.weight = crown_area * size * size;
  ball.count = static_cast<std::uint32_t>(ball.weight);
  surfaces.push_back(ball);
}

void SceneBuilder::ellipsoid(const dvec3& middle, const dvec3& radii, double spacing,
                             const Texture& texture) {
  std::vector<dvec2> half_circle;
  for (int k = 0; k <= 24; ++k) half_circle.emplace_back(circle(k / 48.0).y, -circle(k / 48.0).x);
  const auto look = [&](double angle, double way) {
    return texture(angle > pi ? angle - 2.0 * pi : angle, way - 0.5 * pi);
  };
  lathe(middle, half_circle, spacing / std::cbrt(radii.x * radii.y * radii.z), look, radii);
}

void SceneBuilder::lathe(const dvec3& foot, const std::vector<dvec2>& profile, double spacing,
                         const Texture& texture, const dvec3& stretch) {
  const std::vector<double> way = lengths(profile);
  // Each part between sharp corners is a surface of its own.
  std::size_t from = 0;
  for (std::size_t to = 1; to < profile.size(); ++to) {
    const auto along = [&](std::size_t k) { return glm::normalize(profile[k] - profile[k - 1]); };
    if (to + 1 < profile.size() && glm::dot(along(to), along(to + 1)) > 0.6) continue;
    const double length = way[to] - way[from];
    const auto rows = std::max(1ll, std::llround(length / spacing - 2.0 * margin_at_border + 1.0));
    const Cells cells(length, static_cast<std::uint64_t>(rows), true, true);
    std::size_t k = from + 1;
    for (int j = 0; j < rows; ++j) {
      const double v = way[from] + cells.first + j * cells.size;
      while (k < to && way[k] < v) ++k;
      const dvec2 a = along(k), at = profile[k - 1] + (v - way[k - 1]) * a;
      const int count = std::max(3, static_cast<int>(std::lround(2.0 * pi * at.x / spacing)));
      for (int i = 0; i < count; ++i) {
        const double turn = (i + 0.5 * (j % 2)) / count;
        const dvec2 c = circle(turn);
        const dvec3 around = stretch * dvec3(-c.y, 0.0, c.x),
                    ahead = stretch * dvec3(a.x * c.x, a.y, a.x * c.y);
        disc(foot + stretch * dvec3(at.x * c.x, at.y, at.x * c.y),
             axes_from_normal(glm::normalize(glm::cross(ahead, around)), around),
             flat(2.0 * pi * at.x / count * glm::length(around), cells.size * glm::length(ahead)),
             texture(2.0 * pi * turn, v));
      }
    }
    from = to;
  }
}

void SceneBuilder::tube(const std::vector<dvec3>& points, double radius, double spacing,
                        const Texture& texture) {
  const std::vector<dvec3> path = curve(points, spacing);
  const std::vector<double> way = lengths(path);
  const int around = std::max(5, static_cast<int>(std::lround(2.0 * pi * radius / spacing)));
  dvec3 side(0.3, 0.2, 1.0);  // transported along the path, so that the rings do not twist
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const double length = way[i + 1] - way[i];
    const dvec3 forward = (path[i + 1] - path[i]) / length;
    side = glm::normalize(side - forward * glm::dot(forward, side));
    for (int k = 0; k < around; ++k) {
      const double turn = (k + 0.5 * static_cast<double>(i % 2)) / around;
      const dvec3 normal = circle(turn).x * side + circle(turn).y * glm::cross(forward, side);
      disc(0.5 * (path[i] + path[i + 1]) + 0.9 * radius * normal, axes_from_normal(normal, forward),
           flat(length, 2.0 * pi * radius / around), texture(2.0 * pi * turn, way[i] + 0.5 * length));
    }
  }
}

void SceneBuilder::wire(const std::vector<dvec3>& points, double radius, double spacing,
                        const Material& material) {
  const std::vector<dvec3> path = curve(points, spacing);
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const dvec3 along = path[i + 1] - path[i], forward = glm::normalize(along);
    // A wire has no front: its normal is as near to upwards as possible, which suits light from above.
    const dvec3 upwards = std::abs(forward.y) < 0.95 ? up : -away;
    const dvec3 normal = glm::normalize(upwards - forward * glm::dot(forward, upwards));
    disc(0.5 * (path[i] + path[i + 1]), axes_from_normal(normal, forward),
         {overlap * glm::length(along), 0.6 * radius, 0.6 * radius}, material);
  }
}

}  // namespace binosplat::demo
