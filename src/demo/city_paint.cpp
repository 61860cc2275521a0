// demo:city: what the walls and roofs of its houses are made of.

#include <algorithm>
#include <cmath>

#include "demo/city_parts.h"

namespace binosplat::demo::city {

namespace {

constexpr dvec3 stone{0.56, 0.54, 0.51};

/// A number in [0, 1) that belongs to a wall and two integers.
double lot(const Wall& wall, int a, int b) { return hash(wall.number * 977 + a, b); }

/// A pane behind its frame; (a, b) in metres from the opening's lower left corner.
Material window_look(const Wall& wall, const House& house, const Opening& opening, int key, double a,
                     double b) {
  const double wide = opening.u1 - opening.u0, tall = opening.v1 - opening.v0;
  const double border = std::min({a, wide - a, b, tall - b});
  const bool bar = std::abs(a - 0.5 * wide) < 0.025 || std::abs(b - 0.66 * tall) < 0.025;
  if (border < 0.06 || bar) return {.colour = house.trim * 0.98, .gloss = 0.1};
  const double up = b / tall;
  Material glass{.colour = mix(dvec3(0.20, 0.23, 0.26), dvec3(0.46, 0.55, 0.64), up), .gloss = 0.8};
  const double curtain = 0.16 + 0.2 * lot(wall, key, 3);
  if (lot(wall, key, 4) < 0.55 && std::min(a, wide - a) < curtain * wide) {
    const double fold = std::abs(a * 14.0 - std::floor(a * 14.0) - 0.5);
    glass = {.colour = dvec3(0.74, 0.72, 0.67) * (0.72 + 0.4 * fold), .gloss = 0.4};
  } else if (lot(wall, key, 5) < 0.2 && up > 0.45 + 0.4 * lot(wall, key, 6)) {
    glass = {.colour = dvec3(0.72, 0.68, 0.58), .gloss = 0.4};  // a blind
  } else if (lot(wall, key, 7) < 0.06) {
    glass.colour = mix(glass.colour, dvec3(0.95, 0.72, 0.40), 0.6);
    glass.glow = 0.35;
  }
  return glass;
}

Material door_look(const House& house, const Opening& opening, double a, double b) {
  const double wide = opening.u1 - opening.u0;
  if (std::min(a, wide - a) < 0.07 || b > opening.v1 - opening.v0 - 0.07) return {.colour = house.trim};
  if (b > 1.98) return {.colour = dvec3(0.30, 0.34, 0.38), .gloss = 0.8};
  const double x = std::abs(a - 0.5 * wide), y = std::abs(b - 1.05);
  const bool groove = std::abs(x - 0.30) < 0.02 || (x < 0.3 && std::abs(y - 0.08) < 0.02);
  const bool knob = std::abs(a - 0.2) < 0.035 && std::abs(b - 1.05) < 0.035;
  if (knob) return {.colour = dvec3(0.85, 0.75, 0.45), .gloss = 0.6};
  return {.colour = house.door * (groove ? 0.6 : 1.0), .gloss = 0.25};
}

/// A shop window with shelves behind it.
Material shop_look(const Wall& wall, const House& house, const Opening& opening, int key, double a,
                   double b) {
  const double wide = opening.u1 - opening.u0, tall = opening.v1 - opening.v0;
  if (std::min({a, wide - a, b, tall - b}) < 0.07) return {.colour = house.door * 0.8, .gloss = 0.3};
  const double shelf = b / 0.52, place = a / 0.34;
  const int row = static_cast<int>(shelf), column = static_cast<int>(place) + 40 * row;
  const double size = 0.25 + 0.5 * lot(wall, key, 100 + column);
  const bool goods = shelf - row < size && std::abs(place - std::floor(place) - 0.5) < 0.4 && row < 3;
  dvec3 colour = mix(dvec3(0.62, 0.52, 0.38), dvec3(0.86, 0.74, 0.54), b / tall);
  if (goods) {
    for (int c = 0; c < 3; ++c) colour[c] = 0.30 + 0.45 * lot(wall, 10 * key + c, 200 + column);
  } else if (shelf - row < 0.06) {
    colour = {0.36, 0.26, 0.18};
  }
  return {.colour = colour * 0.8, .gloss = 0.7, .glow = 0.25};
}

Material brick_look(const House& house, double u, double v) {
  const double course = v / 0.075, row = std::floor(course);
  const double along = u / 0.225 + 0.5 * (static_cast<std::int64_t>(row) & 1), column = std::floor(along);
  const bool joint = course - row < 0.14 || along - column < 0.05;
  if (joint) return {.colour = mix(house.wall, dvec3(0.72, 0.68, 0.62), 0.6)};
  const double own =
      hash(static_cast<std::int64_t>(row) * 4099 + house.number, static_cast<std::int64_t>(column));
  return {.colour = house.wall * (0.82 + 0.34 * own)};
}

}  // namespace

Opening opening_of(const City& city, const Wall& wall, int floor, int column) {
  const House& house = city.houses[wall.house];
  const double cell = wall.width / wall.columns, middle = (column + 0.5) * cell;
  const double half = std::min(0.58, 0.5 * cell - 0.3);
  const auto between = [&](Opening::Kind kind, double wide, double v0, double v1) {
    return Opening{kind, middle - wide, middle + wide, v0, v1};
  };
  if (wall.is_front && floor == 0) {
    const int door = static_cast<int>(lot(wall, 0, 1) * wall.columns);
    if (column == door) return between(Opening::Kind::door, std::min(0.55, half), 0.0, 2.4);
    if (house.shop) return between(Opening::Kind::shop, 0.5 * cell - 0.22, 0.45, 2.55);
  }
  if (!wall.is_front && lot(wall, floor, 20 + column) < 0.35) return between(Opening::Kind::none, 0, 0, 0);
  const double sill = floor * house.floor_height + 0.95;
  return between(Opening::Kind::window, half, sill, sill + 1.55);
}

Material masonry_at(const House& house, double u, double v) {
  Material look = house.brick ? brick_look(house, u, v) : Material{.colour = house.wall};
  // Weather: large soft spots, and streaks below the eaves.
  const double spots = fractal(0.6 * u + 13.0 * house.number, 0.45 * v);
  const double streaks = noise(3.0 * u + 7.0 * house.number, 0.25 * v);
  look.colour *= 0.88 + 0.17 * spots + 0.05 * streaks;
  look.colour *= 0.86 + 0.14 * ramp(-0.3, 1.3, v);
  return look;
}

Material wall_at(const City& city, const Wall& wall, double u, double v) {
  const House& house = city.houses[wall.house];
  const int floor = static_cast<int>(v / house.floor_height);
  if (v >= 0.0 && floor < house.floors && u >= 0.0 && u < wall.width) {
    const int column = std::min(wall.columns - 1, static_cast<int>(u * wall.columns / wall.width));
    const Opening o = opening_of(city, wall, floor, column);
    if (o.kind != Opening::Kind::none) {
      const double out = std::max({o.u0 - u, u - o.u1, o.v0 - v, v - o.v1});
      if (out < 0.0) {
        const int key = 32 * floor + column;
        const double a = u - o.u0, b = v - o.v0;
        if (o.kind == Opening::Kind::door) return door_look(house, o, a, b);
        const auto look = o.kind == Opening::Kind::shop ? shop_look : window_look;
        return look(wall, house, o, key, a, b);
      }
      if (out < 0.11 && v > 0.05) return {.colour = house.trim * 0.95};
      const bool sign = o.kind == Opening::Kind::shop && v > o.v1 && v < o.v1 + 0.5;
      if (sign) return {.colour = mix(house.door, dvec3(0.5), 0.15), .gloss = 0.2};
    }
  }
  if (v < 0.5) return {.colour = stone * (0.82 + 0.2 * noise(2.0 * u + wall.number, 3.0 * v))};
  if (v > house.eave - 0.3) return {.colour = house.trim};
  const double line = v - house.floor_height * std::max(1.0, std::floor(v / house.floor_height + 0.5));
  if (wall.is_front && std::abs(line + 0.06) < 0.07) return {.colour = house.trim * 0.93};
  return masonry_at(house, u, v);
}

Material roof_at(const House& house, double u, double v) {
  const double mottled = 0.84 + 0.3 * fractal(0.5 * u + 5.0 * house.number, 0.5 * v);
  if (house.roof_rise == 0.0) return {.colour = house.roof * mottled};
  const double course = v / 0.28, along = u / 0.22;
  const double own = hash(static_cast<std::int64_t>(std::floor(course)) * 8191 + house.number,
                          static_cast<std::int64_t>(std::floor(along)));
  const double edge = 0.72 + 0.28 * ramp(0.0, 0.35, course - std::floor(course));
  return {.colour = house.roof * (mottled * edge * (0.92 + 0.16 * own)), .gloss = 0.12};
}

}  // namespace binosplat::demo::city
