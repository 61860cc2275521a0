// demo:city: what closes the view: towers, hills and the sky.

#include <algorithm>
#include <cmath>

#include "demo/city_parts.h"

namespace binosplat::demo::city {

namespace {

constexpr dvec3 horizon{0.84, 0.88, 0.92};

Material tower_at(const Tower& tower, double u, double v) {
  const std::uint32_t number = tower.number;
  const dvec3 wall = mix(dvec3(0.78, 0.73, 0.66), dvec3(0.52, 0.55, 0.60), hash(number, 1));
  if (tower.tiers == 5) {  // the church
    const bool slit =
        std::abs(u / 5.0 - std::floor(u / 5.0) - 0.5) < 0.12 && v - 14.0 * std::floor(v / 14.0) > 8.0;
    return {.colour = slit ? dvec3(0.25, 0.24, 0.23) : dvec3(0.80, 0.74, 0.62)};
  }
  const double a = u / 3.2, b = v / 3.4;
  const bool window = std::abs(a - std::floor(a) - 0.5) < 0.34 && std::abs(b - std::floor(b) - 0.5) < 0.32;
  if (!window) return {.colour = wall};
  const double own =
      hash(static_cast<std::int64_t>(std::floor(a)) + 100 * number, static_cast<std::int64_t>(std::floor(b)));
  return {.colour = mix(dvec3(0.26, 0.31, 0.37), dvec3(0.50, 0.57, 0.63), own), .gloss = 0.5};
}

/// Wooded hills, already hazy.
Material hill_at(std::uint32_t range, double u, double v) {
  const double woods = fractal(0.02 * u + 9.0, 0.03 * v + range);
  const dvec3 near = mix(dvec3(0.44, 0.55, 0.52), dvec3(0.58, 0.65, 0.55), woods);
  return {.colour = mix(near, horizon, range == 0 ? 0.25 : 0.60), .lit = false};
}

Material sky_at(const City& city, const dvec3& direction) {
  const double up = -direction.y;
  dvec3 colour = mix(horizon, dvec3(0.35, 0.56, 0.84), ramp(-0.05, 0.65, up));
  const double flat = 1.0 / (std::max(up, 0.0) + 0.14);
  const auto shift = static_cast<double>(city.seed % 1000);
  const double cloud = fractal(0.85 * flat * direction.x + shift, 0.85 * flat * direction.z + 40.0);
  colour = mix(colour, dvec3(0.98, 0.97, 0.96), ramp(0.53, 0.72, cloud) * ramp(0.02, 0.16, up));
  return {.colour = colour, .lit = false};
}

void add_tower(Builder& builder, const Tower& tower) {
  double below = 0.0;
  for (int k = 0; k < tower.tiers; ++k) {
    const double half = 0.5 * tower.width * (1.0 - 0.17 * k);
    const double top = tower.height * (k + 1) / tower.tiers;
    builder.box({tower.foot, dmat3(1)}, {-half, -top, -half}, {half, k == 0 ? 12.0 : -below, half},
                {.texture = texture_of<tower_at>(tower), .coarseness = 0.8});
    below = top;
  }
}

/// Points around the city, the perimeter of a square brought to a circle: way 0 to 8.
dvec3 around(double way, double radius) {
  const int side = static_cast<int>(way / 2.0);
  const double t = way - 2.0 * side - 1.0;
  const dvec2 corner = side == 0   ? dvec2(t, 1)
                       : side == 1 ? dvec2(1, -t)
                       : side == 2 ? dvec2(-t, -1)
                                   : dvec2(-1, t);
  const dvec2 unit = glm::normalize(corner);
  return sky_centre + radius * dvec3(unit.x, 0.0, unit.y);
}

void add_city_hills(Builder& builder, std::uint32_t range, double radius, double tallest) {
  constexpr int columns = 96;
  const auto ridge = [&](int k) {
    const double height = tallest * (0.25 + fractal(0.09 * std::abs(k - 0.5 * columns), 3.0 + 8.0 * range));
    return around(8.0 * (k % columns) / columns, radius) - dvec3(0.0, height, 0.0);
  };
  const dvec3 down(0.0, tallest + 60.0, 0.0);
  for (int k = 0; k < columns; ++k) {
    const dvec3 a = ridge(k), b = ridge(k + 1);
    builder.sheet({.corner = b + down,
                   .u = a - b,
                   .v = -down,
                   .texture = [range](double x, double y) { return hill_at(range, x, y); },
                   .at = {30.0 * k, 0.0},
                   .borders = border_high,
                   .coarseness = 3.0});
  }
}

/// The upper half of a cube, brought to a ball.
void add_city_sky(Builder& builder) {
  constexpr int cells = 8;
  const auto point = [](const dvec3& p) { return sky_centre + sky_distance * glm::normalize(p); };
  const auto face = [&](const dvec3& middle, const dvec3& right, const dvec3& up, int from_row) {
    for (int j = from_row; j < cells; ++j) {
      for (int i = 0; i < cells; ++i) {
        const double x = 2.0 * i / cells - 1.0, y = 2.0 * j / cells - 1.0, step = 2.0 / cells;
        const dvec3 corner = middle + x * right + y * up;
        const dvec3 a = point(corner), b = point(corner + step * right), c = point(corner + step * up);
        const dvec3 u = glm::normalize(b - a), v = glm::normalize(c - a);
        const auto sky = [=, &city = builder.city](double along, double upwards) {
          return sky_at(city, glm::normalize(a + along * u + upwards * v - sky_centre));
        };
        builder.sheet({.corner = a, .u = b - a, .v = c - a, .texture = sky, .coarseness = 7.0});
      }
    }
  };
  const dvec3 up(0, -1, 0);
  constexpr int below_horizon = cells / 2 - 1;
  face({0, 0, 1}, {1, 0, 0}, up, below_horizon);
  face({0, 0, -1}, {-1, 0, 0}, up, below_horizon);
  face({1, 0, 0}, {0, 0, -1}, up, below_horizon);
  face({-1, 0, 0}, {0, 0, 1}, up, below_horizon);
  face(up, {1, 0, 0}, {0, 0, -1}, 0);
}

}  // namespace

void add_far_away(Builder& builder) {
  for (const Tower& tower : builder.city.towers) add_tower(builder, tower);
  add_city_hills(builder, 0, 2250.0, 75.0);
  add_city_hills(builder, 1, 2500.0, 150.0);
  add_city_sky(builder);
}

}  // namespace binosplat::demo::city
