// Houses of demo:city: distant ones are painted blocks, near ones have windows set into the wall.

#include <algorithm>
#include <cmath>

#include "demo/city_parts.h"

namespace binosplat::demo {

namespace {

/// If the grain in m is coarser than this, the houses of a row are one block.
constexpr double grain_of_rows = 5.0;
constexpr double grain_of_openings = 0.25;  // with a finer grain, windows are recessed
constexpr double row_depth = 11.0;
constexpr double hidden = 1.6;    // coarseness of parts that are hardly visible from streets
constexpr double overhang = 0.3;  // of roofs, m

struct House {
  LocalAxes frame;  // the front's left corner on the ground; x along the front, y down, z inwards
  double width, floor_height;
  int floors;
  double roof_rise;  // 0: a flat roof
  bool brick, shop;
  dvec3 wall, trim, door, roof;
  std::int64_t number;             // seed for other differences between houses
  double left = 0.0, right = 0.0;  // heights of the neighbours' eaves; 0 at the end of a row

  double eave() const { return floors * floor_height + 0.45; }
};
/// A side of a house with windows. Positions are in metres from its left end and above the ground.
struct Wall {
  House house;
  LocalAxes frame;  // like House::frame, for this side seen from outside
  double width;
  bool is_front;
  std::int64_t number;

  int columns() const { return std::max(1, static_cast<int>(width / 2.45)); }
  double lot(int a, int b) const { return hash(number * 977 + a, b); }
};

struct Opening {
  enum class Kind { none, window, door, shop };
  Kind kind;
  double u0, u1, v0, v1;
};

Opening opening_of(const Wall& wall, int floor, int column) {
  const double cell = wall.width / wall.columns(), middle = (column + 0.5) * cell;
  const auto opening = [&](Opening::Kind kind, double half, double v0, double v1) {
    return Opening{kind, middle - half, middle + half, v0, v1};
  };
  if (wall.is_front && floor == 0) {
    const bool door = column == static_cast<int>(wall.lot(0, 1) * wall.columns());
    if (door) return opening(Opening::Kind::door, 0.55, 0.0, 2.4);
    if (wall.house.shop) return opening(Opening::Kind::shop, 0.5 * cell - 0.22, 0.45, 2.55);
  }
  const bool blind = !wall.is_front && wall.lot(floor, 20 + column) < 0.35;
  const double sill = floor * wall.house.floor_height + 0.95;
  return opening(blind ? Opening::Kind::none : Opening::Kind::window, 0.58, sill, sill + 1.55);
}

/// Returns an opening's material, `a` m to the right and `b` m above its lower left corner.
Material pane_at(const Wall& wall, const Opening& o, int key, double a, double b) {
  const House& house = wall.house;
  const double wide = o.u1 - o.u0, tall = o.v1 - o.v0;
  const double border = std::min({a, wide - a, b, tall - b}), x = std::abs(a - 0.5 * wide);
  if (o.kind == Opening::Kind::door && b < 2.0) {
    const double groove = std::abs(std::max(x, std::abs(part_of(b, 1.0) - 0.5)) - 0.38);
    return {.colour = house.door * (groove < 0.03 ? 0.6 : 1.0), .gloss = 0.25};
  }
  if (o.kind == Opening::Kind::shop) {  // goods behind glass
    const dvec3 dye = circle(hash_at(a / 0.34 + 40.0 * key, b / 0.52)).x * dvec3(0.09, 0.02, -0.06);
    return {.colour = border < 0.07 ? house.door * 0.8 : dvec3(0.48, 0.44, 0.37) + dye,
            .gloss = 0.7,
            .glow = 0.14};
  }
  if (border < 0.06 || x < 0.025 || std::abs(b - 1.0) < 0.025) return {.colour = house.trim, .gloss = 0.1};
  if (wall.lot(key, 4) < 0.55 && x > wide * (0.32 - 0.2 * wall.lot(key, 3)))  // curtains
    return {.colour = dvec3(0.74, 0.72, 0.67) * (0.72 + 0.4 * std::abs(part_of(14.0 * a, 1.0) - 0.5)),
            .gloss = 0.4};
  return {.colour = mix({0.20, 0.23, 0.26}, {0.46, 0.55, 0.64}, b / tall),
          .gloss = 0.8,
          .glow = wall.lot(key, 7) < 0.06 ? 2.0 : 0.0};
}

Material masonry_at(const House& house, double u, double v) {
  const double shift = 13.0 * static_cast<double>(house.number);
  const dvec3 mortar = mix(house.wall, dvec3(0.72, 0.68, 0.62), 0.6);
  const dvec3 colour = house.brick ? bricks(u + shift, v, house.wall, mortar) : house.wall;
  // Weathering: large soft spots, and dirt near the ground.
  const double spots = 0.88 + 0.20 * fractal(0.6 * u + shift, 0.45 * v);
  return {.colour = colour * (spots * (0.86 + 0.14 * ramp(-0.3, 1.3, v)))};
}

Material wall_at(const Wall& wall, double u, double v) {
  const House& house = wall.house;
  const int floor = static_cast<int>(v / house.floor_height);
  if (floor < house.floors) {
    const int column = std::min(wall.columns() - 1, static_cast<int>(u * wall.columns() / wall.width));
    const Opening o = opening_of(wall, floor, column);
    const double out = std::max({o.u0 - u, u - o.u1, o.v0 - v, v - o.v1});
    if (o.kind != Opening::Kind::none) {
      if (out < 0.0) return pane_at(wall, o, 32 * floor + column, u - o.u0, v - o.v0);
      if (out < 0.11 && v > 0.05) return {.colour = house.trim * 0.95};
    }
  }
  if (v < 0.5) return {.colour = dvec3(0.56, 0.54, 0.51) * (0.82 + 0.2 * noise(2.0 * u, 3.0 * v))};
  if (v > house.eave() - 0.3) return {.colour = house.trim};
  const double above = part_of(v, house.floor_height);
  if (wall.is_front && above > house.floor_height - 0.13) return {.colour = house.trim * 0.93};
  return masonry_at(house, u, v);
}

Material roof_at(const House& house, double u, double v) {
  const double shift = 100.0 * static_cast<double>(house.number);
  const double mottled = 0.84 + 0.3 * fractal(0.5 * u + shift, 0.5 * v);
  if (house.roof_rise == 0.0) return {.colour = house.roof * mottled};
  const double tile = 0.92 + 0.16 * hash_at(u / 0.22 + shift, v / 0.28);
  const double edge = 0.72 + 0.28 * ramp(0.0, 0.35, part_of(v / 0.28, 1.0));
  return {.colour = house.roof * (mottled * tile * edge), .gloss = 0.12};
}

void add_opening(SceneBuilder& stage, const Wall& wall, const Opening& o) {
  const double deep = o.kind == Opening::Kind::window ? 0.16 : 0.24;
  // The four sides of the recess.
  const dvec3 round[] = {{o.u0, -o.v0, 0}, {o.u0, -o.v1, 0}, {o.u1, -o.v1, 0}, {o.u1, -o.v0, 0}};
  for (std::size_t k = 0; k < 4; ++k)
    stage.sheet(round[k], round[(k + 1) % 4] - round[k], deep * away, Material{wall.house.trim * 0.9});
  if (o.kind != Opening::Kind::shop) return;
  const auto stripes = [colour = mix(wall.house.door, dvec3(0.6), 0.15)](double u, double) {
    return Material{part_of(u, 0.6) < 0.3 ? colour : dvec3(0.90, 0.88, 0.82)};
  };
  const dvec3 edge(o.u0 - 0.1, 0.35 - o.v1, -1.1);
  stage.sheet(edge, (o.u1 - o.u0 + 0.2) * right, {0.0, -0.55, 1.1}, stripes, Grain(), all_borders);
}

void add_wall(SceneBuilder& stage, const Wall& wall) {
  const House& house = wall.house;
  const Texture look = [wall](double u, double v) { return wall_at(wall, u, v); };
  const Grain grain(wall.is_front ? 1.0 : hidden);
  const auto piece = [&](double u0, double u1, double v0, double v1, double deep) {
    if (u1 - u0 > 0.02 && v1 - v0 > 0.02)
      stage.sheet({{u0, -v0, deep}, (u1 - u0) * right, (v1 - v0) * up, look, grain, 0, {u0, v0}});
  };
  stage.frame = wall.frame;
  if (stage.grain({0.5 * wall.width, -3.0, 0.0}) > grain_of_openings)
    return piece(0.0, wall.width, 0.0, house.eave(), 0.0);
  const double cell = wall.width / wall.columns(), storey = house.floor_height;
  piece(0.0, wall.width, house.floors * storey, house.eave(), 0.0);
  for (int k = 0; k < house.floors * wall.columns(); ++k) {
    const int floor = k / wall.columns(), column = k % wall.columns();
    const double u0 = cell * column, u1 = u0 + cell, v0 = floor * storey, v1 = v0 + storey;
    const Opening o = opening_of(wall, floor, column);
    if (o.kind == Opening::Kind::none) {
      piece(u0, u1, v0, v1, 0.0);
      continue;
    }
    piece(u0, o.u0, v0, v1, 0.0);
    piece(o.u1, u1, v0, v1, 0.0);
    piece(o.u0, o.u1, v0, o.v0, 0.0);
    piece(o.u0, o.u1, o.v1, v1, 0.0);
    piece(o.u0, o.u1, o.v0, o.v1, o.kind == Opening::Kind::window ? 0.16 : 0.24);
    add_opening(stage, wall, o);
  }
}

/// Adds the parts that show above a lower neighbour: a strip of wall, and the gable.
void add_side(SceneBuilder& stage, const House& house, const dvec3& corner, const dvec3& along,
              double neighbour) {
  const Texture look = [house](double u, double v) { return masonry_at(house, u, v); };
  const auto strip = [&](double inset, double v0, double v1) {
    stage.sheet({corner + inset * along + v0 * up,
                 (1.0 - 2.0 * inset) * along,
                 (v1 - v0) * up,
                 look,
                 Grain(hidden),
                 border_left | border_right,
                 {row_depth * inset, v0}});
  };
  if (neighbour < house.eave()) strip(0.0, neighbour, house.eave());
  if (neighbour > house.eave() + 0.5 * house.roof_rise || house.roof_rise == 0.0) return;
  const int strips = std::clamp(static_cast<int>(house.roof_rise / (3.0 * stage.grain(corner))), 1, 16);
  const double tall = house.roof_rise / strips;
  for (int k = 0; k < strips; ++k)
    strip(0.5 * (k + 0.4) / strips, house.eave() + k * tall, house.eave() + (k + 1) * tall);
}

void add_roof(SceneBuilder& stage, const House& house) {
  const double half = 0.5 * row_depth, slope = house.roof_rise / half, eave = house.eave();
  const dvec3 along = house.width * right;
  const Texture look = [house](double u, double v) { return roof_at(house, u, v); };
  if (house.roof_rise == 0.0) return stage.sheet({0.0, 0.15 - eave, 0.0}, along, row_depth * away, look);
  const unsigned ends = (house.left < eave ? border_left : 0u) | (house.right < eave ? border_right : 0u);
  const dvec3 rise = (half + overhang) * dvec3(0.0, -slope, 1.0), fall = rise * dvec3(1.0, -1.0, 1.0);
  const dvec3 ridge(0.0, -eave - house.roof_rise, half);
  stage.sheet(ridge - rise, along, rise, look, Grain(1.25), ends | border_low);
  stage.sheet(ridge, along, fall, look, Grain(1.25), ends | border_high);
}

void add_house(SceneBuilder& stage, const House& house) {
  const LocalAxes& frame = house.frame;
  const double w = house.width, eave = house.eave(), ridge = eave + house.roof_rise;
  const auto wall = [&](const dvec3& corner, const dvec3& to_right, double width, int side) {
    const LocalAxes own{frame.at(corner), frame.axes * dmat3(to_right, down, glm::cross(to_right, down))};
    add_wall(stage, {house, own, width, side == 0, 4 * house.number + side});
  };
  wall({}, right, w, 0);
  wall({w, 0.0, row_depth}, -right, w, 1);
  // The ends of rows have walls with windows.
  if (house.left == 0.0) wall({0.0, 0.0, row_depth}, -away, row_depth, 2);
  if (house.right == 0.0) wall({w, 0.0, 0.0}, away, row_depth, 3);
  stage.frame = frame;
  add_side(stage, house, row_depth * away, -row_depth * away, house.left > 0.0 ? house.left : eave);
  add_side(stage, house, w * right, row_depth * away, house.right > 0.0 ? house.right : eave);
  add_roof(stage, house);
  stage.solid(Solid::Shape::box, {0.0, -eave, 0.0}, {w, 0.0, row_depth});
  if (house.roof_rise == 0.0) return;
  stage.solid(Solid::Shape::roof, {0.0, -ridge, 0.0}, {w, -eave, row_depth});
  if (stage.grain({}) > 0.8) return;
  const double x = w * (0.15 + 0.7 * hash(house.number, 31));
  const dvec3 colour = mix(house.roof, dvec3(0.45, 0.33, 0.28), 0.6);
  const auto chimney = [=](double u, double v) {
    return Material{colour * (0.85 + 0.25 * noise(9.0 * u, 9.0 * v))};
  };
  stage.box({x - 0.35, -ridge - 0.9, 4.6}, {x + 0.35, 0.9 - ridge, 5.8}, Grain(), chimney);
}

House house_by_lot(Random& random, bool main_street) {
  static const dvec3 clays[] = {
      {0.60, 0.36, 0.28}, {0.53, 0.32, 0.27}, {0.68, 0.50, 0.37}, {0.48, 0.35, 0.31}};
  static const dvec3 plasters[] = {{0.84, 0.79, 0.67}, {0.80, 0.79, 0.75}, {0.82, 0.69, 0.51},
                                   {0.78, 0.60, 0.50}, {0.68, 0.73, 0.68}, {0.65, 0.71, 0.77},
                                   {0.83, 0.73, 0.68}, {0.74, 0.72, 0.68}};
  static const dvec3 trims[] = {{0.86, 0.85, 0.82}, {0.82, 0.78, 0.71}, {0.75, 0.74, 0.72}};
  static const dvec3 doors[] = {
      {0.16, 0.28, 0.24}, {0.48, 0.14, 0.13}, {0.17, 0.22, 0.36}, {0.38, 0.25, 0.16}};
  static const dvec3 roofs[] = {
      {0.60, 0.33, 0.25}, {0.51, 0.30, 0.25}, {0.37, 0.36, 0.38}, {0.45, 0.38, 0.34}};
  House house;
  house.width = random.uniform(7.0, 13.0);
  house.floors = static_cast<int>(random.uniform(2.0, main_street ? 5.6 : 4.4));
  house.floor_height = random.uniform(2.9, 3.35);
  house.roof_rise = random.uniform() < 0.15 ? 0.0 : 0.5 * row_depth * random.uniform(0.55, 0.95);
  house.brick = random.uniform() < 0.45;
  house.shop = random.uniform() < (main_street ? 0.55 : 0.12);
  house.wall = house.brick ? pick(random, clays) : pick(random, plasters);
  house.trim = pick(random, trims);
  house.door = pick(random, doors);
  house.roof = house.roof_rise == 0.0 ? dvec3(0.46, 0.45, 0.44) : pick(random, roofs);
  house.number = static_cast<std::int64_t>(random.bits() >> 48);
  return house;
}

}  // namespace

void add_row(SceneBuilder& stage, Random& random, const dvec3& start, const dvec3& to_right, double length) {
  std::vector<House> houses;
  double sum = 0.0, begin = 0.0;
  while (sum < length - 7.0) {
    houses.push_back(house_by_lot(random, std::abs(start.x) < 30.0));
    sum += houses.back().width;
  }
  const dmat3 axes(to_right, down, glm::cross(to_right, down));
  stage.frame = {};
  if (stage.grain(start + 0.5 * length * to_right) > grain_of_rows) {
    houses.resize(1);
    houses[0].left = houses[0].right = 1e9;  // as if taller neighbours hid its ends
    sum = houses[0].width;
  }
  for (std::size_t k = 0; k < houses.size(); ++k) {
    houses[k].width *= length / sum;
    houses[k].frame = {start + begin * to_right, axes};
    if (k > 0) houses[k].left = houses[k - 1].eave();
    if (k + 1 < houses.size()) houses[k].right = houses[k + 1].eave();
    begin += houses[k].width;
    add_house(stage, houses[k]);
  }
}

}  // namespace binosplat::demo
