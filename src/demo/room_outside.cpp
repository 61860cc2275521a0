// demo:room: the world outside the window: sky, sun, hills, a meadow and trees. Nothing here is lit by the
// room.
#include <algorithm>
#include <cmath>
#include <functional>

#include "demo/room_parts.h"

namespace binosplat::demo::room {

namespace {

Material unlit(const dvec3& colour, double opacity = 0.98) {
  return {.colour = colour, .opacity = opacity, .lit = false};
}

/// A direction from the middle of the room: azimuth from straight ahead to the right, elevation upwards, in
/// degrees.
dvec3 bearing(double azimuth, double elevation) {
  const double a = glm::radians(azimuth), e = glm::radians(elevation);
  return {std::sin(a) * std::cos(e), -std::sin(e), std::cos(a) * std::cos(e)};
}

/// Calls `place` for azimuths that the window shows, `step` degrees apart straight ahead and farther apart to
/// the sides.
void along_horizon(double step, const std::function<void(double azimuth, double step)>& place) {
  constexpr double horizon = 76.0;
  for (double side : {-1.0, 1.0}) {
    for (double azimuth = side < 0 ? step : 0.0; azimuth < horizon;) {
      const double wide = step * (1.0 + std::pow(azimuth / 45.0, 2.0));
      place(side * azimuth, wide);
      azimuth += wide;
    }
  }
}

void add_room_sky(Stage& stage, const dvec3& to_sun) {
  constexpr double distance = 420.0, rise = 1.35;
  for (double elevation = -1.0; elevation < 46.0; elevation += rise) {
    along_horizon(rise / std::cos(glm::radians(elevation)), [&](double azimuth, double step) {
      const dvec3 direction = bearing(azimuth, elevation);
      const double glow = std::max(0.0, glm::dot(direction, to_sun));
      dvec3 colour = mix(dvec3(0.96, 0.86, 0.72), dvec3(0.40, 0.60, 0.86), ramp(-4.0, 32.0, elevation));
      const double cloud = fractal(0.055 * azimuth + 40.0, 0.16 * elevation + 3.0);
      colour = mix(colour, dvec3(1.0, 0.94, 0.87), 0.85 * ramp(0.50, 0.66, cloud));
      colour += dvec3(0.50, 0.36, 0.18) * std::pow(glow, 40.0);
      const double wide = 0.85 * glm::radians(step) * std::cos(glm::radians(elevation)) * distance;
      const double tall = 0.85 * glm::radians(rise) * distance;
      stage.disc(distance * direction, axes_from_normal(-direction, {0, 1, 0}), {tall, wide, 0.1 * tall},
                 unlit(colour));
    });
  }
  const dmat3 axes = axes_from_normal(-to_sun, {0, 1, 0});
  stage.disc(405.0 * to_sun, axes, {7, 7, 1}, unlit({3.0, 2.8, 2.3}, 0.99));
  stage.disc(400.0 * to_sun, axes, {26, 26, 1}, unlit({1.5, 1.25, 0.9}, 0.45));
}

/// A range of hills: columns of discs from below the horizon up to a ridge of noise.
void add_room_hills(Stage& stage, double distance, double tallest, const dvec3& dark, const dvec3& light,
                    double seed) {
  along_horizon(0.75, [&](double azimuth, double step) {
    const double ridge =
        tallest * (0.25 + 0.75 * fractal(0.045 * azimuth + seed, seed)) + 0.5 * fractal(0.7 * azimuth, seed);
    const double tall = 0.62;
    for (double elevation = ridge; elevation > -1.5; elevation -= tall) {
      const dvec3 direction = bearing(azimuth, elevation);
      const double patch = fractal(0.25 * azimuth + seed, 0.9 * elevation + 5.0);
      // Fields: flat stripes of lighter and darker green; the ridge catches the sun.
      const double sunlit = ramp(0.35, 0.65, patch) * 0.7 + 0.3 * ramp(ridge - 1.2, ridge, elevation);
      const double degree = glm::radians(1.0) * distance;
      stage.disc(distance * direction, axes_from_normal(-direction, {0, 1, 0}),
                 {0.72 * tall * degree, 0.75 * step * degree, 0.05 * degree},
                 unlit(mix(dark, light, sunlit)));
    }
  });
}

/// Meadow that starts three metres below the window and runs to the foot of the hills, with a path through
/// it.
void add_meadow(Stage& stage) {
  for (double distance = 5.0; distance < 140.0; distance *= 1.09) {
    along_horizon(std::max(1.0, 2.6 - 0.02 * distance), [&](double azimuth, double step) {
      const double a = glm::radians(azimuth);
      const dvec3 p(distance * std::sin(a), 3.0 + 0.5 * noise(0.1 * distance, 0.05 * azimuth),
                    2.2 + distance * std::cos(a));
      const double tuft = fractal(0.30 * p.x, 0.12 * p.z);
      dvec3 colour = mix(dvec3(0.30, 0.42, 0.15), dvec3(0.66, 0.64, 0.26), ramp(0.25, 0.75, tuft));
      if (hash(static_cast<std::int64_t>(p.x * 7.0), static_cast<std::int64_t>(p.z * 5.0)) < 0.06)
        colour = {0.86, 0.50, 0.42};
      const double path = p.x + 2.5 - 4.0 * std::sin(0.06 * p.z);
      if (std::abs(path) < 0.9 + 0.01 * p.z) colour = mix({0.78, 0.68, 0.50}, {0.68, 0.58, 0.42}, tuft);
      colour = mix(colour, dvec3(0.70, 0.70, 0.48), 0.7 * ramp(40.0, 140.0, distance));
      stage.disc(p, axes_from_normal({0, -1, 0}, {std::cos(a), 0, -std::sin(a)}),
                 {0.75 * glm::radians(step) * distance, 0.07 * distance, 0.015 * distance}, unlit(colour));
    });
  }
}

void add_room_tree(Stage& stage, const dvec3& foot, double size, double seed) {
  stage.wire({foot, foot - dvec3(0, 0.5 * size, 0)}, 0.035 * size, 0.1 * size, unlit({0.30, 0.22, 0.16}));
  for (int i = 0; i < 420; ++i) {
    const double y = stage.random.uniform(-1.0, 1.0);
    const double angle = stage.random.uniform(0.0, 2.0 * pi);
    const double lump = 0.75 + 0.25 * std::sin(3.0 * angle + seed) * std::cos(4.0 * y + seed);
    const double r = std::sqrt(1.0 - y * y) * lump * std::sqrt(stage.random.uniform(0.3, 1.0));
    const dvec3 offset(0.38 * r * std::cos(angle), -0.70 + 0.36 * y * lump, 0.38 * r * std::sin(angle));
    const double lit =
        std::clamp(0.45 - 0.4 * y - 0.25 * r * std::cos(angle) + 0.5 * (hash(i, 77) - 0.5), 0.0, 1.0);
    const double turn = stage.random.uniform(0.0, pi);
    stage.disc(foot + size * offset, axes_from_normal({0, 0, -1}, {std::cos(turn), std::sin(turn), 0}),
               {0.034 * size, 0.021 * size, 0.015 * size},
               unlit(mix(dvec3(0.16, 0.27, 0.10), dvec3(0.68, 0.66, 0.24), lit), 0.9));
  }
}

}  // namespace

void add_outside(Stage& stage, const dvec3& to_sun) {
  add_room_sky(stage, to_sun);
  add_room_hills(stage, 380.0, 9.0, {0.50, 0.58, 0.70}, {0.66, 0.70, 0.77}, 4.0);
  add_room_hills(stage, 260.0, 6.0, {0.38, 0.50, 0.48}, {0.62, 0.68, 0.54}, 11.0);
  add_room_hills(stage, 150.0, 3.2, {0.24, 0.37, 0.20}, {0.62, 0.62, 0.30}, 23.0);
  add_meadow(stage);
  const dvec3 ground(0, 3.2, 0);
  add_room_tree(stage, ground + dvec3(-5.5, 0, 17.0), 6.5, 1);
  add_room_tree(stage, ground + dvec3(-11.0, 0, 30.0), 7.0, 2);
  add_room_tree(stage, ground + dvec3(4.0, 0, 38.0), 6.0, 3);
  add_room_tree(stage, ground + dvec3(9.0, 0, 55.0), 7.5, 4);
}

}  // namespace binosplat::demo::room
