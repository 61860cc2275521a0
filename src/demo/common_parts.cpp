#include "demo/common_parts.h"

#include <algorithm>
#include <cmath>

namespace binosplat::demo {

namespace {

dvec3 sky_colour(const Sky& sky, const dvec3& direction) {
  const double high = -direction.y;
  // Two ranges of hills; the farther one is higher and hazier.
  for (int range = 0; range < 2; ++range) {
    const double ridge = fractal(3.0 * direction.x + 9.0 * range + 5.0, 3.0 * direction.z + 7.0);
    if (high > (0.03 + 0.04 * range) * (0.3 + ridge)) continue;
    const double woods = fractal(30.0 * direction.x + 40.0, 30.0 * direction.z + 300.0 * high);
    return mix(mix({0.36, 0.48, 0.34}, {0.58, 0.64, 0.46}, woods), {0.64, 0.72, 0.82}, 0.25 + 0.5 * range);
  }
  dvec3 colour = mix({0.88, 0.88, 0.88}, {0.36, 0.57, 0.85}, ramp(-0.05, 0.6, high));
  const double flat = 0.85 / (std::max(high, 0.0) + 0.14);
  const double cloud = fractal(flat * direction.x + sky.clouds, flat * direction.z + 40.0);
  colour = mix(colour, dvec3(0.98, 0.97, 0.96), ramp(0.53, 0.72, cloud) * ramp(0.02, 0.16, high));
  double near_sun = std::max(0.0, glm::dot(direction, sky.to_sun));
  for (int k = 0; k < 5; ++k) near_sun *= near_sun;  // power of 32
  return colour + dvec3(0.40, 0.32, 0.18) * near_sun;
}

}  // namespace

Camera head_of(const char* name, const dvec3& eye, const dvec3& at, double fov_degrees) {
  Camera camera = look_at(eye, at, up, fov_degrees, 1280, 720);
  camera.name = name;
  return camera;
}

dvec3 bricks(double u, double v, const dvec3& colour, const dvec3& mortar) {
  const double course = std::floor(v / 0.075), along = u / 0.225 + 0.5 * part_of(course, 2.0);
  if (v / 0.075 - course < 0.16 || along - std::floor(along) < 0.055) return mortar;
  const double tone = hash_at(along, course), other = hash_at(along + 99.0, course);
  return colour * mix(dvec3(0.76, 0.72, 0.72), dvec3(1.16, 1.22, 1.26), tone) * (0.92 + 0.16 * other);
}

void add_tree(SceneBuilder& stage, const dvec3& foot, double radius, const dvec3& colour, double coarseness) {
  const double own = hash_at(100.0 * foot.x, 100.0 * foot.z);
  const dvec3 middle = foot + radius * (2.1 + 0.3 * own) * up;
  const double grain = stage.grain(foot, coarseness);
  const auto leaves = [=](double reach, double out) {  // darker inside
    return Material{.colour = colour * (0.5 + 0.35 * ramp(0.25, 0.95, reach) + 0.25 * ramp(-0.2, 0.8, out))};
  };
  stage.crown(middle, radius, coarseness, leaves, static_cast<std::uint32_t>(own * 0x1p32));
  if (grain > 0.5 * radius) return;
  const auto bark = [](double angle, double v) {
    return Material{.colour = dvec3(0.40, 0.33, 0.27) * (0.75 + 0.4 * noise(3.0 * angle, 5.0 * v))};
  };
  stage.tube({foot, middle + 0.5 * radius * down}, 0.075 * radius, grain, bark);
}

void add_sky(SceneBuilder& stage, const Sky& sky) {
  constexpr int cells = 8;  // along an edge of a cube whose upper half is projected onto a sphere
  const auto face = [&](const dvec3& middle, const dvec3& to_right, const dvec3& upwards, int from_row) {
    for (int j = from_row; j < cells; ++j) {
      for (int i = 0; i < cells; ++i) {
        const auto point = [&](int x, int y) {
          return glm::normalize(middle + (2.0 * x / cells - 1.0) * to_right +
                                (2.0 * y / cells - 1.0) * upwards);
        };
        const dvec3 a = point(i, j), b = point(i + 1, j), c = point(i, j + 1);
        if (!sky.is_seen(0.5 * (b + c))) continue;
        const dvec3 u = glm::normalize(b - a) / sky.distance, v = glm::normalize(c - a) / sky.distance;
        const auto look = [=](double along, double high) {
          return Material{.colour = sky_colour(sky, glm::normalize(a + along * u + high * v)), .lit = false};
        };
        stage.sheet(sky.distance * a, 1.05 * sky.distance * (b - a), 1.05 * sky.distance * (c - a), look,
                    Grain(sky.coarseness));
      }
    }
  };
  for (const dvec3& middle : {away, -away, right, -right})
    face(middle, glm::cross(middle, up), up, cells / 2 - 1);
  face(up, right, -away, 0);
}

}  // namespace binosplat::demo
