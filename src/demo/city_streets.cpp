// demo:city: the ground: roads with their markings, pavements, yards, and fields around the city.

#include <algorithm>
#include <cmath>

#include "demo/city_parts.h"

namespace binosplat::demo::city {

namespace {

constexpr double edge_x = streets_beside * street_pitch + front + 4.0;  // of the city
constexpr double grain_of_kerbs = 0.8, grain_of_slopes = 1.0, grain_of_yard_walls = 1.5,
                 grain_of_blocks = 2.5;

double part_of(double value, double period) { return value - period * std::floor(value / period); }

Material asphalt(double x, double z) {
  const double patches = fractal(0.35 * x + 31.0, 0.22 * z), grit = noise(19.0 * x, 19.0 * z);
  const dvec3 grey(0.345, 0.35, 0.365);
  return {.colour = grey * (0.82 + 0.24 * patches + 0.12 * grit), .gloss = 0.16};
}

Material marking(double x, double z) {
  const double worn = 0.82 + 0.12 * noise(6.0 * x, 6.0 * z);
  return {.colour = dvec3(0.90, 0.90, 0.87) * worn, .gloss = 0.1};
}

/// A street along z, crossings included; x is from its middle.
Material road_at(double x, double z) {
  const double along = part_of(z - first_crossing, crossing_pitch);
  const double from_crossing = std::min(along, crossing_pitch - along);
  if (from_crossing > side_road) {
    const bool zebra = from_crossing > 5.0 && from_crossing < 8.2;
    if (zebra && part_of(x + 0.25, 1.0) < 0.5 && std::abs(x) < 4.2) return marking(x, z);
    if (!zebra && from_crossing > 9.0) {
      if (std::abs(x) < 0.07 && part_of(z, 5.0) < 2.2) return marking(x, z);
      if (std::abs(std::abs(x) - 2.45) < 0.05 && part_of(z, 5.4) < 4.9) return marking(x, z);  // parking
    }
    if (from_crossing > 8.6 && from_crossing < 8.95 && (along < 50.0 ? x > 0.1 : x < -0.1))
      return marking(x, z);
  }
  const double cover = glm::length(dvec2(x - 1.2, part_of(z, 37.0) - 18.0));
  if (cover < 0.34) return {.colour = dvec3(cover > 0.29 ? 0.22 : 0.31), .gloss = 0.25};
  Material look = asphalt(x, z);
  look.colour *= 0.84 + 0.16 * ramp(0.0, 0.4, road - std::abs(x));  // dirt in the gutter
  return look;
}

Material side_road_at(double x, double z) {
  const double dash = part_of(x, 4.0);
  if (std::abs(z) < 0.06 && dash < 1.6) return marking(x, z);
  return asphalt(x, z);
}

Material pavement_at(double x, double z) {
  const double i = std::floor(x / 0.5), j = std::floor(z / 0.75);
  const double a = x - 0.5 * i, b = z - 0.75 * j;
  const double own = hash(static_cast<std::int64_t>(i) + 5000, static_cast<std::int64_t>(j));
  const dvec3 slab = dvec3(0.66, 0.645, 0.615) * (0.92 + 0.1 * own + 0.08 * fractal(0.8 * x, 0.8 * z));
  const bool joint = std::min(a, b) < 0.025;
  return {.colour = slab * (joint ? 0.78 : 1.0), .gloss = 0.06};
}

Material kerb_at(double u, double) {
  return {.colour = dvec3(0.70, 0.69, 0.67) * (part_of(u, 1.0) < 0.03 ? 0.75 : 1.0)};
}

Material yard_at(double x, double z) {
  const double tufts = fractal(0.4 * x + 3.0, 0.4 * z + 8.0), blades = noise(9.0 * x, 9.0 * z);
  const dvec3 grass = mix(dvec3(0.27, 0.38, 0.15), dvec3(0.47, 0.52, 0.24), tufts);
  return {.colour = grass * (0.88 + 0.24 * blades)};
}

/// A whole block: a yard with pavements around it.
Material block_at(double x, double z) {
  const bool yard =
      x > front && x < street_pitch - front && z > side_front && z < crossing_pitch - side_front;
  return yard ? yard_at(x, z) : pavement_at(x, z);
}

Material yard_wall_at(double u, double v) {
  return {.colour = dvec3(0.62, 0.55, 0.47) * (0.85 + 0.2 * fractal(1.5 * u, 2.0 * v))};
}

/// Fields with hedges, each of its own green or yellow.
Material fields_at(double x, double z) {
  const double u = x / 90.0 + 0.6 * noise(x / 240.0, z / 240.0),
               v = z / 70.0 + 0.6 * noise(z / 200.0, x / 200.0);
  const double own =
      hash(static_cast<std::int64_t>(std::floor(u)), static_cast<std::int64_t>(std::floor(v)) + 70);
  const double hedge = std::min(part_of(u, 1.0), part_of(v, 1.0));
  if (hedge < 0.06) return {.colour = dvec3(0.22, 0.31, 0.15)};
  const dvec3 field = mix(dvec3(0.33, 0.45, 0.19), dvec3(0.66, 0.61, 0.33), own * own);
  return {.colour = field * (0.9 + 0.2 * fractal(0.05 * x, 0.05 * z))};
}

/// A rectangle of the plan, which lies `height` above the relief and has its slope.
struct Ground {
  dvec2 low, high;
  double height = 0.0;
  dvec2 middle{0.0};  // where the texture's zero lies
  double coarseness = 1.0;
};

void add_ground(Builder& builder, const Texture& texture, const Ground& g) {
  const Relief& relief = builder.city.relief;
  const dvec2 middle = 0.5 * (g.low + g.high);
  const bool coarse = builder.grain_at(relief.at(middle.x, middle.y)) > grain_of_slopes;
  const int pieces = std::max(1, static_cast<int>((g.high.y - g.low.y) / (coarse ? 100.0 : 20.0)));
  const auto z_at = [&](int k) { return g.low.y + (g.high.y - g.low.y) * k / pieces; };
  for (int k = 0; k < pieces; ++k) {
    const dvec3 corner = relief.at(g.low.x, z_at(k), g.height);
    builder.sheet({.corner = corner,
                   .u = relief.at(g.high.x, z_at(k), g.height) - corner,
                   .v = relief.at(g.low.x, z_at(k + 1), g.height) - corner,
                   .texture = texture,
                   .at = dvec2(g.low.x, z_at(k)) - g.middle,
                   .coarseness = g.coarseness});
  }
}

/// The stone edge of a pavement, facing the road.
void add_kerb(Builder& builder, const dvec2& from, const dvec2& to) {
  const Relief& relief = builder.city.relief;
  const dvec3 a = relief.at(from.x, from.y), b = relief.at(to.x, to.y);
  if (builder.grain_at(0.5 * (a + b)) > grain_of_kerbs) return;
  builder.sheet({.corner = a, .u = b - a, .v = dvec3(0, -kerb, 0), .texture = kerb_at});
}

/// The pavements, the yard and the kerbs of the block right of the street at x, from a crossing at z on.
void add_block(Builder& builder, double x, double z) {
  const dvec2 low(x + road, z + side_road), high(x + street_pitch - road, z + crossing_pitch - side_road);
  const dvec2 yard_low(x + front, z + side_front),
      yard_high(x + street_pitch - front, z + crossing_pitch - side_front);
  if (builder.grain_at(builder.city.relief.at(0.5 * (low.x + high.x), 0.5 * (low.y + high.y))) >
      grain_of_blocks) {
    add_ground(builder, block_at, {.low = low, .high = high, .height = kerb, .middle = {x, z}});
    return;
  }
  add_ground(builder, pavement_at, {low, {yard_low.x, high.y}, kerb});
  add_ground(builder, pavement_at, {{yard_high.x, low.y}, high, kerb});
  add_ground(builder, pavement_at, {{yard_low.x, low.y}, {yard_high.x, yard_low.y}, kerb});
  add_ground(builder, pavement_at, {{yard_low.x, yard_high.y}, {yard_high.x, high.y}, kerb});
  const double inner = row_depth - 1.0;
  add_ground(builder, yard_at,
             {.low = {yard_low.x + inner, yard_low.y},
              .high = {yard_high.x - inner, yard_high.y},
              .height = kerb,
              .coarseness = 2.0});
  constexpr int pieces = 8;
  for (int k = 0; k < pieces; ++k) {
    const auto at = [&](int i) { return low + (high - low) * (static_cast<double>(i) / pieces); };
    const dvec2 p = at(k), q = at(k + 1);
    add_kerb(builder, {low.x, p.y}, {low.x, q.y});
    add_kerb(builder, {high.x, q.y}, {high.x, p.y});
    add_kerb(builder, {q.x, low.y}, {p.x, low.y});
    add_kerb(builder, {p.x, high.y}, {q.x, high.y});
  }
  for (const double end : {yard_low.y + 0.3, yard_high.y - 0.5}) {  // walls close the yard between the rows
    const Frame frame{builder.city.relief.at(yard_low.x + row_depth, end, kerb), dmat3(1)};
    const double wide = yard_high.x - yard_low.x - 2.0 * row_depth;
    if (builder.grain_at(frame.at(0.5 * wide, 0, 0)) > grain_of_yard_walls) continue;
    builder.box(frame, {0.0, -2.3, 0.0}, {wide, 0.5, 0.25}, {.texture = yard_wall_at});
  }
}

}  // namespace

void add_streets(Builder& builder) {
  for (int i = -streets_beside; i <= streets_beside; ++i) {
    const double x = street_pitch * i;
    for (int j = 0; j <= blocks_along; ++j) {
      const double z = first_crossing + crossing_pitch * j;
      const double end = z + (j < blocks_along ? crossing_pitch - side_road : side_road);
      add_ground(builder, road_at,
                 {.low = {x - road, z - side_road}, .high = {x + road, end}, .middle = {x, 0.0}});
      if (i == streets_beside) continue;
      add_ground(builder, side_road_at,
                 {.low = {x + road, z - side_road},
                  .high = {x + street_pitch - road, z + side_road},
                  .middle = {0.0, z}});
      if (j < blocks_along) add_block(builder, x, z);
    }
  }
  // Around the city; the fields lie a little lower where they pass beneath its rim.
  constexpr double around = 2700.0, rim = -0.1;
  const double start = first_crossing - side_road, end = last_crossing + side_road;
  const double city_x = streets_beside * street_pitch + road;
  for (const double side : {-1.0, 1.0}) {  // pavements of the outermost streets, then fields
    const double a = side * city_x, b = side * edge_x;
    add_ground(
        builder, pavement_at,
        {.low = {std::min(a, b), start}, .high = {std::max(a, b), end}, .height = kerb, .coarseness = 2.0});
    add_ground(builder, fields_at,
               {.low = {side < 0.0 ? -around : edge_x, start},
                .high = {side < 0.0 ? -edge_x : around, end},
                .height = rim,
                .coarseness = 5.0});
  }
  add_ground(builder, fields_at,
             {.low = {-around, -around + 400.0}, .high = {around, start}, .height = rim, .coarseness = 5.0});
  add_ground(builder, fields_at,
             {.low = {-around, end}, .high = {around, around + 400.0}, .height = rim, .coarseness = 5.0});
}

}  // namespace binosplat::demo::city
