// demo:city: the plan. What stands where, drawn by lot from the seed.

#include <algorithm>
#include <cmath>

#include "demo/city_parts.h"

namespace binosplat::demo::city {

namespace {

constexpr dvec3 down{0, 1, 0};

/// One of a list of colours.
template <std::size_t n>
dvec3 pick(Random& random, const std::array<dvec3, n>& colours) {
  return colours[static_cast<std::size_t>(random.uniform() * n)];
}

constexpr std::array bricks = {dvec3(0.64, 0.36, 0.27), dvec3(0.56, 0.31, 0.25), dvec3(0.71, 0.51, 0.36),
                               dvec3(0.50, 0.34, 0.30)};
constexpr std::array plasters = {dvec3(0.90, 0.84, 0.71), dvec3(0.92, 0.90, 0.85), dvec3(0.88, 0.73, 0.53),
                                 dvec3(0.83, 0.62, 0.51), dvec3(0.72, 0.78, 0.72), dvec3(0.69, 0.76, 0.83),
                                 dvec3(0.90, 0.79, 0.73), dvec3(0.79, 0.77, 0.72)};
constexpr std::array trims = {dvec3(0.92, 0.91, 0.88), dvec3(0.86, 0.82, 0.74), dvec3(0.78, 0.77, 0.75)};
constexpr std::array doors = {dvec3(0.16, 0.28, 0.24), dvec3(0.48, 0.14, 0.13), dvec3(0.17, 0.22, 0.36),
                              dvec3(0.38, 0.25, 0.16), dvec3(0.78, 0.62, 0.22)};
constexpr std::array roofs = {dvec3(0.62, 0.32, 0.23), dvec3(0.52, 0.29, 0.23), dvec3(0.37, 0.36, 0.38),
                              dvec3(0.45, 0.38, 0.34)};
constexpr std::array leaves = {dvec3(0.42, 0.52, 0.20), dvec3(0.34, 0.47, 0.20), dvec3(0.52, 0.56, 0.22)};
constexpr std::array paints = {dvec3(0.74, 0.12, 0.11), dvec3(0.86, 0.87, 0.88), dvec3(0.20, 0.22, 0.24),
                               dvec3(0.20, 0.34, 0.56), dvec3(0.56, 0.58, 0.60), dvec3(0.20, 0.38, 0.33),
                               dvec3(0.86, 0.78, 0.60)};

class Planner {
 public:
  explicit Planner(std::uint64_t seed) : random_(seed) {
    city_.seed = seed;
    const double side = random_.uniform() < 0.5 ? -1.0 : 1.0;
    city_.relief.bend = side * random_.uniform(5.0, 9.0);
    city_.relief.rise = random_.uniform(24.0, 36.0);
  }

  City plan() {
    for (int i = -streets_beside; i <= streets_beside; ++i) {
      for (int j = 0; j < blocks_along; ++j) {
        for (const double side : {-1.0, 1.0}) {
          const bool outside = i == (side < 0.0 ? -streets_beside : streets_beside);
          add_street_side(street_pitch * i, first_crossing + crossing_pitch * j, side, outside);
        }
        if (i < streets_beside) add_yard(street_pitch * i, first_crossing + crossing_pitch * j);
      }
    }
    add_towers();
    return std::move(city_);
  }

 private:
  /// A frame whose x axis follows the ground from z0 to z1 at x, as seen by somebody who stands on the
  /// street's side of it; `side` is where it lies, seen along the street.
  Frame frame_beside(double x, double z0, double z1, double side) const {
    const dvec3 a = city_.relief.at(x, z0, kerb), b = city_.relief.at(x, z1, kerb);
    const dvec3 along = glm::normalize(dvec3(b.x - a.x, 0.0, b.z - a.z));
    const dvec3 right = side > 0.0 ? -along : along;
    Frame frame{side > 0.0 ? b : a, dmat3(right, down, glm::cross(right, down))};
    frame.origin.y = 0.5 * (a.y + b.y);
    return frame;
  }

  void add_street_side(double x, double crossing, double side, bool outside) {
    const double z0 = crossing + side_front, z1 = crossing + crossing_pitch - side_front;
    if (!outside) add_row(x + side * front, z0, z1, side);
    for (double z = z0 + 3.0; z < z1 - 5.0; z += random_.uniform(10.0, 15.0)) {
      if (random_.uniform() < 0.25) continue;
      add_tree(x + side * 5.6, z, 1.7, 2.4);
    }
    for (double z = z0 + (side < 0.0 ? 6.0 : 18.0); z < z1; z += 25.0) {
      const dvec3 foot = city_.relief.at(x + side * 5.0, z, kerb);
      city_.lamps.push_back({foot, dmat3(dvec3(-side, 0, 0), down, dvec3(0, 0, -side))});
    }
    for (double z = z0 + 8.5; z < z1 - 8.0; z += 5.4) {
      if (random_.uniform() < 0.45) continue;
      add_car(x + side * 3.45, z + random_.uniform(-0.3, 0.3), side);
    }
  }

  void add_tree(double x, double z, double smallest, double largest) {
    Tree tree;
    tree.foot = city_.relief.at(x, z, kerb);
    tree.radius = random_.uniform(smallest, largest);
    tree.trunk = tree.radius * random_.uniform(1.1, 1.4);
    tree.leaves = pick(random_, leaves);
    tree.number = static_cast<std::uint32_t>(city_.trees.size());
    city_.trees.push_back(tree);
    const dvec3 middle = tree.foot - dvec3(0, tree.trunk + tree.radius, 0);
    city_.casters.push_back(
        {.shape = Caster::Shape::ball, .frame = Frame{middle, dmat3(1)}, .radius = tree.radius});
  }

  void add_car(double x, double z, double side) {
    const dvec3 a = city_.relief.at(x, z - 2.0), b = city_.relief.at(x, z + 2.0);
    const dvec3 forward = glm::normalize(b - a) * side;
    const dvec3 right = glm::normalize(glm::cross(down, forward));
    const Frame frame{0.5 * (a + b), dmat3(right, glm::cross(forward, right), forward)};
    city_.cars.push_back({frame, pick(random_, paints)});
    city_.casters.push_back({.shape = Caster::Shape::block,
                             .frame = Frame{frame.at(-0.85, 0, -2.0), frame.axes},
                             .width = 1.7,
                             .depth = 4.0,
                             .eave = 1.1});
  }

  void add_row(double x, double z0, double z1, double side) {
    std::vector<double> widths;
    const double length = z1 - z0;
    double sum = 0.0;
    while (sum < length - 7.0) {
      widths.push_back(random_.uniform(7.0, 13.0));
      sum += widths.back();
    }
    Row row;
    row.first = static_cast<std::uint32_t>(city_.houses.size());
    row.length = length;
    const bool main_street = std::abs(x) < street_pitch / 2.0;
    double begin = 0.0;
    for (double& width : widths) {
      width *= length / sum;
      const double low = side > 0.0 ? z1 - begin - width : z0 + begin;
      add_house(frame_beside(x, low, low + width, side), width, begin, main_street);
      begin += width;
    }
    row.end = static_cast<std::uint32_t>(city_.houses.size());
    add_neighbours(row);
    const dvec3 from = city_.relief.at(x, side > 0.0 ? z1 : z0, kerb);
    const dvec3 to = city_.relief.at(x, side > 0.0 ? z0 : z1, kerb);
    row.frame = {from, frame_beside(x, z0, z1, side).axes};
    row.along = to - from;
    row.eave = row.roof_rise = 0.0;
    for (std::uint32_t h = row.first; h < row.end; ++h) {
      row.eave += city_.houses[h].eave / (row.end - row.first);
      row.roof_rise += city_.houses[h].roof_rise / (row.end - row.first);
    }
    city_.rows.push_back(row);
  }

  void add_house(const Frame& frame, double width, double begin, bool main_street) {
    House house;
    house.frame = frame;
    house.width = width;
    house.begin = begin;
    house.number = static_cast<std::uint32_t>(city_.houses.size());
    house.floors = static_cast<int>(random_.uniform(2.0, main_street ? 5.6 : 4.4));
    house.floor_height = random_.uniform(2.9, 3.35);
    house.eave = house.floors * house.floor_height + 0.45;
    house.roof_rise = random_.uniform() < 0.15 ? 0.0 : 0.5 * row_depth * random_.uniform(0.55, 0.95);
    house.brick = random_.uniform() < 0.45;
    house.shop = random_.uniform() < (main_street ? 0.55 : 0.12);
    house.wall = house.brick ? pick(random_, bricks) : pick(random_, plasters);
    house.trim = pick(random_, trims);
    house.door = pick(random_, doors);
    house.roof = house.roof_rise == 0.0 ? dvec3(0.46, 0.45, 0.44) : pick(random_, roofs);
    city_.houses.push_back(house);
    city_.casters.push_back({.shape = Caster::Shape::block,
                             .frame = frame,
                             .width = width,
                             .depth = row_depth,
                             .eave = house.eave,
                             .roof_rise = house.roof_rise});
  }

  /// Which houses of a row stand beside which, and the walls that follow from it.
  void add_neighbours(const Row& row) {
    for (std::uint32_t h = row.first; h < row.end; ++h) {
      House& house = city_.houses[h];
      house.first_wall = static_cast<std::uint32_t>(city_.walls.size());
      house.left_eave = h > row.first ? city_.houses[h - 1].eave : 0.0;
      house.right_eave = h + 1 < row.end ? city_.houses[h + 1].eave : 0.0;
      const dmat3& axes = house.frame.axes;
      const auto add = [&](const dvec3& corner, const dvec3& right, double width, bool is_front) {
        const int columns = std::max(1, static_cast<int>(width / 2.45));
        const dmat3 own(right, down, glm::cross(right, down));
        city_.walls.push_back({Frame{corner, own}, width, columns, is_front, h,
                               static_cast<std::uint32_t>(city_.walls.size())});
      };
      add(house.frame.origin, axes[0], house.width, true);
      add(house.frame.at(house.width, 0, row_depth), -axes[0], house.width, false);
      if (h == row.first) add(house.frame.at(0, 0, row_depth), -axes[2], row_depth, false);
      if (h + 1 == row.end) add(house.frame.at(house.width, 0, 0), axes[2], row_depth, false);
    }
  }

  /// Trees between the rows of a block.
  void add_yard(double x, double crossing) {
    for (int k = 0; k < 7; ++k) {
      const double across = random_.uniform(front + row_depth + 3.5, street_pitch - front - row_depth - 3.5);
      const double along = random_.uniform(side_front + 4.0, crossing_pitch - side_front - 4.0);
      add_tree(x + across, crossing + along, 1.8, 3.4);
    }
  }

  void add_tower(double x, double z, double width, double height, int tiers) {
    city_.towers.push_back(
        {city_.relief.at(x, z), width, height, tiers, static_cast<std::uint32_t>(city_.towers.size())});
  }

  /// A church tower where the main street ends, and high houses behind and beside the streets.
  void add_towers() {
    add_tower(0.0, last_crossing + 45.0, 15.0, 78.0, 5);
    for (int k = 0; k < 34; ++k) {
      const double x = random_.uniform(-950.0, 950.0), z = random_.uniform(1220.0, 1750.0);
      const double width = random_.uniform(18.0, 42.0), height = random_.uniform(35.0, 150.0);
      if (std::abs(x) > 45.0) add_tower(x, z, width, height, random_.uniform() < 0.4 ? 3 : 1);
    }
    for (int k = 0; k < 26; ++k) {
      const double x = random_.uniform(420.0, 1100.0), z = random_.uniform(100.0, 1300.0);
      const double width = random_.uniform(18.0, 36.0), height = random_.uniform(20.0, 75.0);
      add_tower(k % 2 == 0 ? x : -x, z, width, height, 1);
    }
  }

  City city_;
  Random random_;
};

}  // namespace

dvec3 Relief::at(double x, double z, double height) const {
  const double sideways = bend * (ramp(0.0, 420.0, z) - 1.7 * ramp(380.0, last_crossing, z));
  const double up = rise * ramp(180.0, last_crossing, z) - 3.0 * ramp(20.0, 260.0, z);
  return {x + sideways, -up - height, z};
}

City plan_city(std::uint64_t seed) { return Planner(seed).plan(); }

}  // namespace binosplat::demo::city
