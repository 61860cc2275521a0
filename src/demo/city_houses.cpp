// demo:city: houses: far away a row of them at once, nearer as blocks with painted windows, and near with
// every window set into the wall.

#include <algorithm>
#include <cmath>

#include "demo/city_parts.h"

namespace binosplat::demo::city {

namespace {

// Coarser than this the houses of a row are drawn together; finer than the second, their windows are deep;
// finer than the third, they have sills and cornices.
constexpr double grain_of_rows = 3.5, grain_of_openings = 0.25, grain_of_trim = 0.12;
constexpr double house_foot = 0.8;  // how far walls reach below the ground, where it slopes
constexpr double overhang = 0.3;
constexpr double hidden = 1.6, roof_coarseness = 1.25;  // what streets see little of has fewer Gaussians

/// The house of a row at a place along it.
std::uint32_t house_at(const City& city, const Row& row, double along) {
  std::uint32_t h = row.first;
  while (h + 1 < row.end && city.houses[h + 1].begin <= along) ++h;
  return h;
}

Material row_front_at(const City& city, const Row& row, double u, double v) {
  const House& house = city.houses[house_at(city, row, u)];
  return wall_at(city, city.walls[house.first_wall], u - house.begin, v);
}

Material row_back_at(const City& city, const Row& row, double u, double v) {
  const House& house = city.houses[house_at(city, row, row.length - u)];
  const double from_end = u - (row.length - house.begin - house.width);
  return wall_at(city, city.walls[house.first_wall + 1], from_end, v);
}

class HouseBuilder {
 public:
  HouseBuilder(Builder& builder, std::uint32_t number)
      : builder_(builder), number_(number), house_(builder.city.houses[number]), frame_{house_.trim * 0.9} {
    grain_ = builder.grain_at(house_.frame.at(0.5 * house_.width, -3.0, 0.0));
  }

  void add() {
    for (std::uint32_t w = house_.first_wall; w < builder_.city.walls.size(); ++w) {
      if (builder_.city.walls[w].house != number_) break;
      add_wall(w);
    }
    add_side(true);
    add_side(false);
    add_roof();
    if (grain_ < 0.8 && house_.roof_rise > 0.0) add_chimney();
    if (grain_ < grain_of_trim) add_cornice();
  }

 private:
  /// A piece of a wall, `deep` behind its face.
  void piece(std::uint32_t w, double u0, double u1, double v0, double v1, double deep = 0.0) {
    if (u1 - u0 < 0.02 || v1 - v0 < 0.02) return;
    const Wall& wall = builder_.city.walls[w];
    builder_.sheet(
        {.corner = wall.frame.at(u0, -v0, deep),
         .u = wall.frame.axes[0] * (u1 - u0),
         .v = wall.frame.axes[1] * (v0 - v1),
         .texture = [&city = builder_.city, &wall](double u, double v) { return wall_at(city, wall, u, v); },
         .at = {u0, v0},
         .coarseness = wall.is_front ? 1.0 : hidden});
  }

  void add_wall(std::uint32_t w) {
    const Wall& wall = builder_.city.walls[w];
    const double grain = builder_.grain_at(wall.frame.at(0.5 * wall.width, -3.0, 0.0));
    if (grain > grain_of_openings) {
      piece(w, 0.0, wall.width, -house_foot, house_.eave);
      return;
    }
    piece(w, 0.0, wall.width, -house_foot, 0.0);
    const double top = house_.floors * house_.floor_height;
    piece(w, 0.0, wall.width, top, house_.eave);
    for (int floor = 0; floor < house_.floors; ++floor) {
      for (int column = 0; column < wall.columns; ++column) add_cell(w, floor, column);
    }
  }

  void add_cell(std::uint32_t w, int floor, int column) {
    const Wall& wall = builder_.city.walls[w];
    const double u0 = wall.width * column / wall.columns, u1 = wall.width * (column + 1) / wall.columns;
    const double v0 = floor * house_.floor_height, v1 = v0 + house_.floor_height;
    const Opening o = opening_of(builder_.city, wall, floor, column);
    if (o.kind == Opening::Kind::none) {
      piece(w, u0, u1, v0, v1);
      return;
    }
    piece(w, u0, o.u0, v0, v1);
    piece(w, o.u1, u1, v0, v1);
    piece(w, o.u0, o.u1, v0, o.v0);
    piece(w, o.u0, o.u1, o.v1, v1);
    const double deep = o.kind == Opening::Kind::window ? 0.16 : 0.24;
    piece(w, o.u0, o.u1, o.v0, o.v1, deep);
    add_reveals(wall, o, deep);
    if (grain_ < grain_of_trim && o.kind == Opening::Kind::window) {
      trim_box(wall, {o.u0 - 0.07, -o.v0, -0.1}, {o.u1 + 0.07, 0.07 - o.v0, 0.0});
    }
    if (grain_ < grain_of_trim && o.kind == Opening::Kind::door) {
      trim_box(wall, {o.u0 - 0.1, -0.12, -0.35}, {o.u1 + 0.1, 0.1, 0.0});
    }
    if (o.kind == Opening::Kind::shop) {
      const auto awning = [&house = house_](double u, double) {
        const bool stripe = (static_cast<int>(u / 0.3) & 1) != 0;
        return Material{stripe ? dvec3(0.90, 0.88, 0.82) : mix(house.door, dvec3(0.6), 0.15)};
      };
      builder_.sheet({.corner = wall.frame.at(o.u0 - 0.1, -o.v1 + 0.35, -1.1),
                      .u = wall.frame.axes[0] * (o.u1 - o.u0 + 0.2),
                      .v = wall.frame.axes * dvec3(0.0, -0.55, 1.1),
                      .texture = awning,
                      .borders = all_borders});
    }
  }

  /// The four sides of the hole in which a window sits.
  void add_reveals(const Wall& wall, const Opening& o, double deep) {
    const dvec3 right = wall.frame.axes[0] * (o.u1 - o.u0), up = wall.frame.axes[1] * (o.v0 - o.v1),
                in = wall.frame.axes[2] * deep;
    Surface side{.texture = frame_};
    const auto add = [&](double u, double v, const dvec3& along_u, const dvec3& along_v) {
      side.corner = wall.frame.at(u, -v, 0.0);
      side.u = along_u;
      side.v = along_v;
      builder_.sheet(side);
    };
    add(o.u0, o.v0, up, in);
    add(o.u1, o.v0, in, up);
    add(o.u0, o.v0, in, right);
    add(o.u0, o.v1, right, in);
  }

  void trim_box(const Wall& wall, const dvec3& low, const dvec3& high) {
    builder_.box(wall.frame, low, high, {.texture = frame_});
  }

  /// What stands out beside a lower neighbour: a strip of wall without windows, and the gable.
  void add_side(bool left) {
    const double neighbour = left ? house_.left_eave : house_.right_eave;
    if (neighbour > house_.eave + 0.5 * house_.roof_rise) return;
    const dvec3 along = house_.frame.axes[2] * (left ? -row_depth : row_depth);
    const dvec3 low = house_.frame.at(left ? 0.0 : house_.width, 0.0, left ? row_depth : 0.0);
    Surface side{.texture = texture_of<masonry_at>(house_), .coarseness = hidden};
    if (neighbour > 0.0 && neighbour < house_.eave) {
      side.corner = low + house_.frame.axes[1] * -neighbour;
      side.u = along;
      side.v = house_.frame.axes[1] * (neighbour - house_.eave);
      side.at = {0.0, neighbour};
      side.borders = border_left | border_right;
      builder_.sheet(side);
    }
    const int strips = std::clamp(static_cast<int>(house_.roof_rise / (3.0 * grain_)), 1, 16);
    for (int k = 0; k < strips && house_.roof_rise > 0.0; ++k) {
      const double inset = 0.5 * (k + 0.4) / strips, tall = house_.roof_rise / strips;
      side.corner = low + along * inset - house_.frame.axes[1] * (house_.eave + k * tall);
      side.u = along * (1.0 - 2.0 * inset);
      side.v = house_.frame.axes[1] * -tall;
      side.at = {row_depth * inset, house_.eave + k * tall};
      side.borders = border_left | border_right;
      builder_.sheet(side);
    }
  }

  void add_roof() {
    const double half = 0.5 * row_depth, slope = house_.roof_rise / half;
    const dvec3 right = house_.frame.axes[0] * house_.width;
    const unsigned ends = (house_.left_eave < house_.eave ? border_left : 0u) |
                          (house_.right_eave < house_.eave ? border_right : 0u);
    Surface roof{.u = right, .texture = texture_of<roof_at>(house_), .coarseness = roof_coarseness};
    if (house_.roof_rise == 0.0) {
      roof.corner = house_.frame.at(0.0, -house_.eave + 0.15, 0.0);
      roof.v = house_.frame.axes[2] * row_depth;
      builder_.sheet(roof);
      return;
    }
    roof.borders = ends | border_low;
    roof.corner = house_.frame.at(0.0, -house_.eave + slope * overhang, -overhang);
    roof.v = house_.frame.axes * dvec3(0.0, -slope * (half + overhang), half + overhang);
    builder_.sheet(roof);
    roof.borders = ends | border_high;
    roof.corner = house_.frame.at(0.0, -house_.eave - house_.roof_rise, half);
    roof.v = house_.frame.axes * dvec3(0.0, slope * (half + overhang), half + overhang);
    builder_.sheet(roof);
  }

  void add_chimney() {
    const double x = house_.width * (0.15 + 0.7 * hash(house_.number, 31));
    const double ridge = house_.eave + house_.roof_rise;
    const auto bricks = [&house = house_](double u, double v) {
      const dvec3 colour = mix(house.roof, dvec3(0.45, 0.33, 0.28), 0.6);
      return Material{colour * (0.85 + 0.25 * noise(6.0 * u, 9.0 * v))};
    };
    builder_.box(house_.frame, {x - 0.35, -ridge - 0.9, 0.5 * row_depth - 0.9},
                 {x + 0.35, -ridge + 0.9, 0.5 * row_depth + 0.3}, {.texture = bricks});
  }

  void add_cornice() {
    const Wall& wall = builder_.city.walls[house_.first_wall];
    trim_box(wall, {0.0, -house_.eave, -0.2}, {house_.width, -house_.eave + 0.22, 0.0});
  }

  Builder& builder_;
  std::uint32_t number_;
  const House& house_;
  Material frame_;  // of windows, doors and the cornice
  double grain_;
};

void add_row(Builder& builder, const Row& row) {
  const City& city = builder.city;
  const dvec3 up(0, -1, 0), in = row.frame.axes[2], from = row.frame.origin;
  const double slope = row.roof_rise / (0.5 * row_depth);
  const dvec3 to_ridge = 0.5 * row_depth * (in + slope * up);
  Surface s{.corner = from - house_foot * up, .u = row.along, .v = (row.eave + house_foot) * up};
  s.texture = [&](double u, double v) { return row_front_at(city, row, u, v); };
  s.at = {0.0, -house_foot};
  s.borders = border_left | border_right;
  builder.sheet(s);
  s.corner += row.along + row_depth * in;
  s.u = -row.along;
  s.texture = [&](double u, double v) { return row_back_at(city, row, u, v); };
  builder.sheet(s);
  s.at = {0.0, 0.0};
  s.u = row.along;
  s.texture = [&](double u, double v) { return roof_at(city.houses[house_at(city, row, u)], u, v); };
  s.corner = from + row.eave * up;
  s.v = to_ridge;
  builder.sheet(s);
  s.corner += to_ridge;
  s.v = to_ridge - row.roof_rise * 2.0 * up;
  builder.sheet(s);
}

}  // namespace

void add_houses(Builder& builder) {
  for (const Row& row : builder.city.rows) {
    if (builder.grain_at(row.frame.origin + 0.5 * row.along) > grain_of_rows) {
      add_row(builder, row);
      continue;
    }
    for (std::uint32_t h = row.first; h < row.end; ++h) HouseBuilder(builder, h).add();
  }
}

}  // namespace binosplat::demo::city
