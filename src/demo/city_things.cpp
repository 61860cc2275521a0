// demo:city: trees, street lamps and parked cars.

#include <algorithm>
#include <cmath>

#include "demo/city_parts.h"

namespace binosplat::demo::city {

namespace {

constexpr double grain_of_trees = 3.0, grain_of_trunks = 1.0, grain_of_lamps = 0.6, grain_of_cars = 0.7;

const Material iron{.colour = {0.20, 0.23, 0.23}, .gloss = 0.2};

/// `reach`: how far from the middle of the crown; `out`: how far outside its lump. Deep inside it is dark.
Material leaves_at(const Tree& tree, double reach, double out) {
  return {.colour = tree.leaves * (0.50 + 0.35 * ramp(0.25, 0.95, reach) + 0.25 * ramp(-0.2, 0.8, out))};
}

Material bark_at(const Tree& tree, double u, double v) {
  return {.colour = dvec3(0.40, 0.33, 0.27) * (0.75 + 0.4 * noise(12.0 * u + tree.number, 5.0 * v))};
}

Material lantern_at(double, double v) {
  if (v < 0.06 || v > 0.44) return {.colour = iron.colour};
  return {.colour = {0.96, 0.92, 0.80}, .gloss = 0.3, .glow = 0.35};
}

void add_city_tree(Builder& builder, const Tree& tree) {
  const double grain = builder.grain_at(tree.foot);
  if (grain > grain_of_trees) return;
  const dvec3 up(0, -1, 0);
  builder.ball({.corner = tree.foot + up * (tree.trunk + tree.radius),
                .u = tree.radius * dvec3(1.0, 1.12, 1.0),
                .texture = texture_of<leaves_at>(tree),
                .seed = tree.number});
  if (grain > grain_of_trunks) return;
  const Texture bark = texture_of<bark_at>(tree);
  const double thick = 0.075 * tree.radius;
  if (grain > 2.0 * thick) {
    builder.wire(tree.foot, tree.foot + up * (tree.trunk + 0.5 * tree.radius), thick, bark);
    return;
  }
  // Six sides, narrower above.
  const double half = 0.5, tall = 0.5 * std::sqrt(3.0);
  const std::array<dvec2, 7> hexagon = {dvec2(1, 0),  dvec2(half, tall),   dvec2(-half, tall),
                                        dvec2(-1, 0), dvec2(-half, -tall), dvec2(half, -tall),
                                        dvec2(1, 0)};
  for (std::size_t k = 0; k < 6; ++k) {
    const dvec2 a = thick * hexagon[k + 1], b = thick * hexagon[k];
    const dvec3 corner = tree.foot + dvec3(a.x, 0.1, a.y);
    builder.sheet({.corner = corner,
                   .u = dvec3(b.x - a.x, 0.0, b.y - a.y),
                   .v = up * (tree.trunk + 0.5 * tree.radius),
                   .texture = bark,
                   .at = {0.2 * static_cast<double>(k), 0.0}});
  }
}

void add_lamp(Builder& builder, const Frame& frame) {
  if (builder.grain_at(frame.origin) > grain_of_lamps) return;
  builder.wire(frame.at(0, 0, 0), frame.at(0, -0.9, 0), 0.08, iron);
  builder.wire(frame.at(0, -0.9, 0), frame.at(0, -4.6, 0), 0.045, iron);
  builder.wire(frame.at(0, -4.55, 0), frame.at(0.8, -4.75, 0), 0.03, iron);
  builder.box(frame, {0.62, -4.72, -0.16}, {0.94, -4.22, 0.16}, {.texture = lantern_at});
}

// The side view of a car: where it is along its length (z, forwards) and how high (y, downwards).
constexpr std::array<dvec2, 9> outline = {dvec2(2.08, -0.28),  dvec2(2.12, -0.62),  dvec2(1.96, -0.80),
                                          dvec2(0.98, -0.92),  dvec2(0.28, -1.40),  dvec2(-0.95, -1.43),
                                          dvec2(-1.68, -0.97), dvec2(-2.06, -0.86), dvec2(-2.10, -0.28)};
constexpr double car_half = 0.85, belt = -0.94, side_top = -0.84;

/// By where a point is in the car's frame.
Material car_at(const Car& car, const dvec3& p) {
  const double across = std::abs(p.x), along = std::abs(p.z);
  if (across > car_half - 0.02 && p.y > -0.80) {
    const double wheel = glm::length(dvec2(along - 1.32, p.y + 0.31));
    if (wheel < 0.17) return {.colour = dvec3(0.62, 0.63, 0.65), .gloss = 0.4};
    if (wheel < 0.31) return {.colour = dvec3(0.13)};
    if (wheel < 0.37 || p.y > -0.2) return {.colour = dvec3(0.07)};
  }
  if (p.y < belt - 0.04 && p.y > -1.37) {
    const bool pillar = across > car_half - 0.13 && std::abs(p.z + 0.30) < 0.05;
    const bool before_or_behind = across < car_half - 0.08;
    const bool beside = across > car_half - 0.2 && !pillar;
    if (before_or_behind || beside) return {.colour = dvec3(0.26, 0.30, 0.34), .gloss = 0.9};
  }
  if (along > 1.98 && p.y > -0.78 && p.y < -0.56 && across > 0.5) {
    if (p.z > 0.0) return {.colour = dvec3(0.93, 0.94, 0.92), .gloss = 0.6};
    return {.colour = dvec3(0.72, 0.07, 0.06), .gloss = 0.4};
  }
  if (along > 2.0 && p.y > -0.52 && p.y < -0.40 && across < 0.27) return {.colour = dvec3(0.88, 0.88, 0.82)};
  if (p.y > -0.34) return {.colour = car.paint * 0.35};
  return {.colour = car.paint, .gloss = 0.45};
}

/// Adds a sheet whose corner is given in the car's frame.
void add_panel(Builder& builder, const Car& car, const dvec3& corner, const dvec3& u, const dvec3& v) {
  const dmat3 to_car = glm::transpose(car.frame.axes);
  const dvec3 along_u = to_car * glm::normalize(u), along_v = to_car * glm::normalize(v);
  const auto texture = [=, &car](double a, double b) {
    return car_at(car, corner + a * along_u + b * along_v);
  };
  builder.sheet({.corner = car.frame.at(corner.x, corner.y, corner.z),
                 .u = u,
                 .v = v,
                 .texture = texture,
                 .borders = border_left | border_right,
                 .coarseness = 0.8});
}

void add_car(Builder& builder, const Car& car) {
  if (builder.grain_at(car.frame.origin) > grain_of_cars) return;
  const dmat3& axes = car.frame.axes;
  for (std::size_t k = 0; k + 1 < outline.size(); ++k) {
    const dvec2 a = outline[k], b = outline[k + 1];
    add_panel(builder, car, {car_half, a.y, a.x}, axes[0] * (-2.0 * car_half),
              axes * dvec3(0.0, b.y - a.y, b.x - a.x));
  }
  for (const double side : {-1.0, 1.0}) {
    const auto add = [&](double x, double behind, double ahead, double low, double tall) {
      const double from = side > 0.0 ? behind : ahead, to = side > 0.0 ? ahead : behind;
      add_panel(builder, car, {side * x, low, from}, axes[2] * (to - from), axes[1] * -tall);
    };
    // The body, and the wheels that reach below it.
    add(car_half, -2.10, 2.10, -0.28, -0.28 - side_top);
    add(car_half, -1.68, 1.68, -0.02, 0.28 - 0.02);
    constexpr int strips = 4;  // of the cabin's side, which narrow towards the roof
    for (int k = 0; k < strips; ++k) {
      const double t = (k + 0.5) / strips, tall = (1.41 + side_top) / strips;
      add(car_half - 0.10 * t, -1.68 + (-0.95 + 1.68) * t, 0.98 + (0.30 - 0.98) * t, side_top - k * tall,
          tall);
    }
  }
}

}  // namespace

void add_things(Builder& builder) {
  for (const Tree& tree : builder.city.trees) add_city_tree(builder, tree);
  for (const Frame& lamp : builder.city.lamps) add_lamp(builder, lamp);
  for (const Car& car : builder.city.cars) add_car(builder, car);
}

}  // namespace binosplat::demo::city
