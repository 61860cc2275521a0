// demo:city: trees, street lamps and parked cars.

#include <algorithm>
#include <cmath>

#include "demo/city_parts.h"

namespace binosplat::demo::city {

namespace {

constexpr double grain_of_trees = 3.0, grain_of_trunks = 1.0, grain_of_lamps = 0.6, grain_of_cars = 0.7;

/// `reach`: how far from the middle of the crown; `out`: how far outside its lump. Deep inside it is dark.
Material paint_leaves(const City& city, const Surface& surface, double reach, double out) {
  const Tree& tree = city.trees[surface.subject];
  return {.colour = tree.leaves * (0.50 + 0.35 * ramp(0.25, 0.95, reach) + 0.25 * ramp(-0.2, 0.8, out))};
}

Material paint_bark(const City&, const Surface& surface, double u, double v) {
  return {.colour = dvec3(0.40, 0.33, 0.27) * (0.75 + 0.4 * noise(12.0 * u + surface.subject, 5.0 * v))};
}

Material paint_iron(const City&, const Surface&, double, double) {
  return {.colour = dvec3(0.20, 0.23, 0.23), .gloss = 0.2};
}

Material paint_lantern(const City&, const Surface&, double, double v) {
  if (v < 0.06 || v > 0.44) return {.colour = dvec3(0.20, 0.23, 0.23)};
  return {.colour = dvec3(0.96, 0.92, 0.80), .gloss = 0.3, .glow = 0.35};
}

void add_city_tree(Builder& builder, std::uint32_t number) {
  const Tree& tree = builder.city.trees[number];
  const double grain = builder.grain_at(tree.foot);
  if (grain > grain_of_trees) return;
  const dvec3 up(0, -1, 0);
  builder.ball({.corner = tree.foot + up * (tree.trunk + tree.radius),
                .u = tree.radius * dvec3(1.0, 1.12, 1.0),
                .paint = paint_leaves,
                .subject = number});
  if (grain > grain_of_trunks) return;
  const double thick = 0.075 * tree.radius;
  if (grain > 2.0 * thick) {
    builder.rod(tree.foot, tree.foot + up * (tree.trunk + 0.5 * tree.radius), thick, paint_bark, number);
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
                   .paint = paint_bark,
                   .subject = number,
                   .at = {0.2 * static_cast<double>(k), 0.0}});
  }
}

void add_lamp(Builder& builder, std::uint32_t number) {
  const Frame& frame = builder.city.lamps[number];
  if (builder.grain_at(frame.origin) > grain_of_lamps) return;
  builder.rod(frame.at(0, 0, 0), frame.at(0, -0.9, 0), 0.08, paint_iron, number);
  builder.rod(frame.at(0, -0.9, 0), frame.at(0, -4.6, 0), 0.045, paint_iron, number);
  builder.rod(frame.at(0, -4.55, 0), frame.at(0.8, -4.75, 0), 0.03, paint_iron, number);
  builder.box(frame, {0.62, -4.72, -0.16}, {0.94, -4.22, 0.16}, {.paint = paint_lantern, .subject = number});
}

// The side view of a car: where it is along its length (z, forwards) and how high (y, downwards).
constexpr std::array<dvec2, 9> outline = {dvec2(2.08, -0.28),  dvec2(2.12, -0.62),  dvec2(1.96, -0.80),
                                          dvec2(0.98, -0.92),  dvec2(0.28, -1.40),  dvec2(-0.95, -1.43),
                                          dvec2(-1.68, -0.97), dvec2(-2.06, -0.86), dvec2(-2.10, -0.28)};
constexpr double car_half = 0.85, belt = -0.94, side_top = -0.84;

/// Painted by where a point is in the car's frame.
Material paint_car(const City& city, const Surface& surface, double u, double v) {
  const Car& car = city.cars[surface.subject];
  const dvec3 p = glm::transpose(car.frame.axes) * (surface.point(u, v) - car.frame.origin);
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

/// A side of the cabin, in strips that narrow towards the roof.
void add_cabin_side(Builder& builder, const Frame& frame, double side, Surface sheet) {
  constexpr int strips = 4;
  for (int k = 0; k < strips; ++k) {
    const double t = (k + 0.5) / strips, tall = (1.41 + side_top) / strips;
    const double ahead = 0.98 + (0.30 - 0.98) * t, behind = -1.68 + (-0.95 + 1.68) * t;
    const double x = side * (car_half - 0.10 * t);
    const double from = side > 0.0 ? behind : ahead, to = side > 0.0 ? ahead : behind;
    sheet.corner = frame.at(x, side_top - k * tall, from);
    sheet.u = frame.axes[2] * (to - from);
    sheet.v = frame.axes[1] * -tall;
    builder.sheet(sheet);
  }
}

void add_car(Builder& builder, std::uint32_t number) {
  const Frame& frame = builder.city.cars[number].frame;
  if (builder.grain_at(frame.origin) > grain_of_cars) return;
  Surface sheet{.paint = paint_car, .subject = number, .coarseness = 0.8};
  for (std::size_t k = 0; k + 1 < outline.size(); ++k) {
    const dvec2 a = outline[k], b = outline[k + 1];
    sheet.corner = frame.at(car_half, a.y, a.x);
    sheet.u = frame.axes[0] * (-2.0 * car_half);
    sheet.v = frame.axes * dvec3(0.0, b.y - a.y, b.x - a.x);
    sheet.borders = border_left | border_right;
    builder.sheet(sheet);
  }
  for (const double side : {-1.0, 1.0}) {
    sheet.borders = border_left | border_right;
    // The body, and the wheels that reach below it.
    for (const dvec3& part : {dvec3(2.10, -0.28, side_top), dvec3(1.68, -0.02, -0.28)}) {
      const double behind = side > 0.0 ? -part.x : part.x;
      sheet.corner = frame.at(side * car_half, part.y, behind);
      sheet.u = frame.axes[2] * (-2.0 * behind);
      sheet.v = frame.axes[1] * (part.z - part.y);
      builder.sheet(sheet);
    }
    add_cabin_side(builder, frame, side, sheet);
  }
}

}  // namespace

void add_things(Builder& builder) {
  const City& city = builder.city;
  for (std::uint32_t k = 0; k < city.trees.size(); ++k) add_city_tree(builder, k);
  for (std::uint32_t k = 0; k < city.lamps.size(); ++k) add_lamp(builder, k);
  for (std::uint32_t k = 0; k < city.cars.size(); ++k) add_car(builder, k);
}

}  // namespace binosplat::demo::city
