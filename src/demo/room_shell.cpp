// demo:room: floor, walls, ceiling and window.
#include <algorithm>
#include <cmath>

#include "demo/room_parts.h"

namespace binosplat::demo::room {

namespace {

constexpr double room_width = room_high.x - room_low.x;
constexpr double height = room_high.y - room_low.y;
constexpr double depth = room_high.z - room_low.z;

constexpr dvec3 rug_middle{0.15, 0.0, -0.25};
constexpr dvec2 rug_size{2.6, 1.8};
constexpr double rug_overhang = 0.06;  // of the rug over the floor that is left out under it

const Material hole{.opacity = 0.0};
const dvec3 off_white{0.90, 0.88, 0.83};
const dvec3 right{1, 0, 0}, down{0, 1, 0}, away{0, 0, 1};

/// Planed wood with its grain along u.
dvec3 wood(const dvec3& colour, double u, double v, double seed) {
  const double grain = fractal(1.5 * u + 13.0 * seed, 60.0 * v + 31.0 * seed);
  return colour * (0.78 + 0.44 * grain) * (0.88 + 0.24 * hash(static_cast<std::int64_t>(seed), 3));
}

/// Painted boards between a skirting and a rail; `up` from the floor to the panelling's height.
constexpr double panelling = 0.88;
Material boarding(double u, double up) {
  const bool board = up > 0.13 && up < 0.80;
  const bool edge = std::abs(up - 0.12) < 0.012 || std::abs(up - 0.81) < 0.012;
  const bool groove = board && std::abs(std::remainder(u, 0.12)) < 0.015;
  return {.colour = off_white * (groove ? 0.80 : edge ? 0.70 : 1.0), .gloss = 0.3};
}

/// A pattern of leaves.
Material wallpaper(double u, double up) {
  const dvec3 ground = mix(dvec3(0.30, 0.47, 0.47), dvec3(0.34, 0.52, 0.51), fractal(3.0 * u, 3.0 * up));
  // One in every cell of a brick-like lattice, turned to and fro.
  const double row = std::floor(up / 0.36);
  const bool odd = (static_cast<std::int64_t>(row) & 1) != 0;
  const double x = std::remainder(u + (odd ? 0.19 : 0.0), 0.38), y = up - (row + 0.5) * 0.36;
  const double sway = odd ? 0.5 : -0.5;
  const double across = x - sway * y - 1.5 * y * y * sway, along = y / 0.165;
  const double leaf = 0.075 * std::sqrt(std::max(0.0, 1.0 - along * along)) * (1.0 - 0.35 * along);
  const bool vein = std::abs(std::remainder(y - 0.6 * std::abs(across), 0.07)) < 0.012;
  if (std::abs(across) < 0.012 && std::abs(along) < 1.1) return {.colour = ground};
  if (std::abs(across) < leaf && !vein) return {.colour = mix(ground, dvec3(0.84, 0.79, 0.60), 0.70)};
  return {.colour = ground};
}

Material plaster(double u, double up) {
  return {.colour = dvec3(0.88, 0.80, 0.66) * (0.94 + 0.12 * fractal(2.0 * u, 2.0 * up))};
}

void add_bricks(Stage& stage) {
  constexpr double course = 0.075, brick = 0.225, joint = 0.012;
  const dvec3 corner(room_high.x, 0, room_low.z);  // on the right wall; its front looks to the left
  const auto rows = static_cast<int>(height / course) + 1;
  for (int j = 0; j < rows; ++j) {
    const dvec3 row = corner - course * j * down;
    const double shift = (j % 2) * 0.5 * brick;
    stage.sheet(row - joint * down, depth * away, joint * down, {0.13, joint, Border::overlaps},
                Material{.colour = {0.72, 0.67, 0.60}});
    for (int i = -1; i <= static_cast<int>(depth / brick); ++i) {
      const double from = std::max(0.0, i * brick + shift),
                   to = std::min(depth, (i + 1) * brick + shift - joint);
      if (to - from < 0.02) continue;
      const double tone = hash(i, j);
      const dvec3 colour =
          mix(dvec3(0.52, 0.26, 0.19), dvec3(0.76, 0.47, 0.35), tone) * (0.92 + 0.16 * hash(j, i + 99));
      const dvec3 start = row - course * down + from * away;
      stage.sheet(start, (to - from) * away, (course - joint) * down, {0.055, 0.032, Border::overlaps},
                  [&](double u, double v) {
                    return Material{
                        .colour = colour * (0.88 + 0.24 * fractal(40.0 * u + 9.0 * i, 40.0 * v + 7.0 * j))};
                  });
      stage.sheet(start + (to - from) * away, joint * away, (course - joint) * down,
                  {joint, course, Border::overlaps}, Material{.colour = {0.72, 0.67, 0.60}});
    }
  }
}

/// The pattern of the rug at (x, y) from its middle.
dvec3 woven(double x, double y) {
  const dvec3 red(0.52, 0.18, 0.17), navy(0.17, 0.21, 0.35), cream(0.88, 0.82, 0.70), gold(0.78, 0.60, 0.32);
  const double ax = std::abs(x), ay = std::abs(y);
  const double edge = std::min(0.5 * rug_size.x - ax, 0.5 * rug_size.y - ay);
  if (edge < 0.05) return cream * 0.95;
  if (edge < 0.08) return navy;
  if (edge < 0.26) {  // a border of lozenges
    const double along = 0.5 * rug_size.x - ax < 0.5 * rug_size.y - ay ? y : x;
    const double lozenge = std::abs(std::remainder(along, 0.18)) + 0.8 * std::abs(edge - 0.17);
    return lozenge < 0.035 ? cream : lozenge < 0.065 ? gold : navy;
  }
  if (edge < 0.29) return gold;
  const double medallion = ax / 0.80 + ay / 0.52;
  if (medallion < 0.16) return gold;
  if (medallion < 0.32) return cream;
  if (medallion < 0.42) return red * 0.8;
  if (medallion < 0.72)
    return std::fmod(medallion * 12.0 + 4.0 * std::abs(ax - ay), 1.0) < 0.3 ? cream : navy;
  if (medallion < 0.80) return gold;
  const double flower = std::abs(std::remainder(ax, 0.22)) + std::abs(std::remainder(ay, 0.22));
  return flower < 0.045 ? cream : flower < 0.07 ? navy : red;
}

}  // namespace

void add_floor(Stage& stage) {
  constexpr double plank = 0.15, gap = 0.006;
  for (int k = 0; k * plank < room_width; ++k) {
    const double x = room_low.x + k * plank, across = std::min(plank, room_high.x - x) - gap;
    const double joint = 2.0 * hash(k, 7);  // where one board ends and the next one starts
    stage.sheet(
        {x, 0, room_high.z}, -depth * away, across * right, {0.08, 0.036, Border::overlaps},
        [&](double u, double v) {
          const double seed = k * 10 + std::floor((u + joint) / 2.0);
          return Material{.colour = wood({0.60, 0.41, 0.25}, u, v, seed), .gloss = 3.5, .sharpness = 14};
        });
    stage.sheet({x + across, 0, room_high.z}, -depth * away, gap * right, {0.08, gap, Border::overlaps},
                Material{.colour = {0.22, 0.14, 0.09}});
  }
}

void add_rug(Stage& stage) {
  const dvec2 half = 0.5 * rug_size - rug_overhang;
  stage.group();
  stage.block(Solid::Shape::box, {rug_middle}, {-half.x, -0.009, -half.y}, {half.x, 0.02, half.y});
  const dvec3 corner = rug_middle + dvec3(-0.5 * rug_size.x, -0.012, 0.5 * rug_size.y);
  stage.sheet(corner, -rug_size.y * away, rug_size.x * right, Grain(0.023), [](double u, double v) {
    const dvec3 colour = woven(v - 0.5 * rug_size.x, u - 0.5 * rug_size.y);
    return Material{.colour = colour * (0.9 + 0.2 * noise(70.0 * u, 70.0 * v))};
  });
  for (const double side : {-1.0, 1.0}) {  // fringes
    for (int i = 0; i < 90; ++i) {
      const dvec3 from =
          rug_middle + dvec3(side * 0.5 * rug_size.x, -0.010, rug_size.y * ((i + 0.5) / 90.0 - 0.5));
      const dvec3 to = from + dvec3(side * 0.06, 0.006, 0.02 * (hash(i, 5) - 0.5));
      stage.wire({from, to}, 0.004, 0.025, {.colour = {0.86, 0.80, 0.68}});
    }
  }
}

void add_walls(Stage& stage) {
  // The wall with the window.
  const dvec3 back(room_low.x, 0, room_high.z);
  const auto in_window = [](double u, double up) {
    const double x = room_low.x + u, y = -up;
    return x > window_low.x && x < window_high.x && y > window_low.y && y < window_high.y;
  };
  stage.sheet(back, room_width * right, -panelling * down, {0.028, 0.035, Border::overlaps},
              [&](double u, double up) { return in_window(u, up) ? hole : boarding(u, up); });
  stage.sheet(back - panelling * down, room_width * right, (panelling - height) * down,
              {0.028, 0.028, Border::overlaps}, [&](double u, double v) {
                return in_window(u, panelling + v) ? hole : wallpaper(u, panelling + v);
              });
  // Left: plaster above the same boards.
  const dvec3 left(room_low.x, 0, room_low.z);
  stage.sheet(left, depth * away, -panelling * down, {0.028, 0.040, Border::overlaps}, boarding);
  stage.sheet(left - panelling * down, depth * away, (panelling - height) * down,
              {0.075, 0.075, Border::overlaps}, [](double u, double v) { return plaster(u, panelling + v); });
  add_bricks(stage);
  // Behind the default camera: plaster, with a door.
  stage.sheet({room_low.x, room_low.y, room_low.z}, room_width * right, height * down,
              {0.090, 0.090, Border::overlaps}, [](double u, double v) {
                const double up = height - v, x = std::abs(u - 3.6);
                if (x < 0.45 && up < 2.05) {
                  const bool panel = x < 0.32 && std::abs(std::remainder(up - 0.55, 0.95)) < 0.36;
                  return Material{.colour = dvec3(0.36, 0.44, 0.40) * (panel ? 0.88 : 1.0), .gloss = 0.3};
                }
                if (x < 0.53 && up < 2.13) return Material{.colour = off_white};
                return plaster(u, up);
              });
}

void add_ceiling(Stage& stage) {
  stage.sheet({room_low.x, room_low.y, room_low.z}, depth * away, room_width * right,
              {0.14, 0.14, Border::overlaps}, Material{.colour = {0.93, 0.92, 0.89}});
  const Frame world;
  const auto stucco = Material{.colour = {0.94, 0.93, 0.90}};
  for (int step = 0; step < 2; ++step) {  // a moulding of two steps
    const double out = 0.08 - 0.04 * step, top = room_low.y + 0.04 * step, low = top + 0.04;
    stage.box(world, {room_low.x, top, room_high.z - out}, {room_high.x, low, room_high.z}, {0.08, 0.04},
              stucco);
    stage.box(world, {room_low.x, top, room_low.z}, {room_low.x + out, low, room_high.z}, {0.08, 0.04},
              stucco);
    stage.box(world, {room_high.x - out, top, room_low.z}, {room_high.x, low, room_high.z}, {0.08, 0.04},
              stucco);
  }
}

void add_window(Stage& stage) {
  stage.group();
  const Frame world;
  const auto paint = Material{.colour = {0.95, 0.94, 0.91}, .gloss = 0.5};
  const auto bar = [&](const dvec3& low, const dvec3& high) {
    stage.solid_box(world, low, high, {0.07, 0.028}, paint);
  };
  const double front = room_high.z - 0.02, back = room_high.z + 0.14;
  const dvec2 l = window_low, h = window_high;
  // Reveal and casing, sill below.
  bar({l.x - 0.08, l.y - 0.08, front}, {h.x + 0.08, l.y, back});
  bar({l.x - 0.08, l.y, front}, {l.x, h.y, back});
  bar({h.x, l.y, front}, {h.x + 0.08, h.y, back});
  bar({l.x - 0.12, h.y, front - 0.12}, {h.x + 0.12, h.y + 0.04, back});
  // Sashes: two posts, one cross bar, thinner ones between.
  const double z = room_high.z + 0.06;
  for (int i = 0; i <= 3; ++i) {
    const double x = l.x + (h.x - l.x) * i / 3.0, half = i == 0 || i == 3 ? 0.03 : 0.025;
    bar({std::clamp(x - half, l.x, h.x), l.y, z}, {std::clamp(x + half, l.x, h.x), h.y, z + 0.05});
  }
  for (const double y : {l.y, l.y + 0.52, h.y - 0.05}) bar({l.x, y, z + 0.005}, {h.x, y + 0.05, z + 0.045});
  // Panes: hardly there, but they mirror the lamp and the room.
  stage.sheet({l.x, h.y, z + 0.025}, (l.y - h.y) * down, (h.x - l.x) * right, Grain(0.09),
              Material{.colour = {0.75, 0.84, 0.86}, .opacity = 0.05, .gloss = 2.0, .sharpness = 12});
}

void add_curtains(Stage& stage) {
  constexpr double wide = 0.46, long_ = 2.46, fold = 0.095, swing = 0.028;
  constexpr int columns = 38, rows = 26;
  for (const double left : {window_low.x - 0.40, window_high.x - 0.06}) {
    for (int i = 0; i < columns; ++i) {
      for (int j = 0; j < rows; ++j) {
        const double x = wide * (i + 0.5) / columns, y = -0.05 - long_ * (j + 0.5) / rows;
        const double phase = 2.0 * pi * x / fold,
                     open = swing * (1.0 - 0.4 * j / rows);  // wider folds at the hem
        const double slope = open * std::cos(phase) * 2.0 * pi / fold;
        const dmat3 axes = axes_from_normal(glm::normalize(dvec3(slope, 0, -1)), {1, 0, 0});
        stage.disc({left + x, y, room_high.z - 0.12 + open * std::sin(phase)}, axes,
                   {0.7 * wide / columns * std::sqrt(1.0 + slope * slope), 0.7 * long_ / rows, 0.001},
                   {.colour = {0.93, 0.86, 0.74}, .opacity = 0.72, .two_sided = true});
      }
    }
  }
  const double y = window_low.y - 0.16, z = room_high.z - 0.12;
  stage.tube(curve({{window_low.x - 0.5, y, z}, {window_high.x + 0.5, y, z}}, 0.04), 0.013, 0.012,
             Material{.colour = {0.35, 0.24, 0.16}, .gloss = 1.0});
  for (const double x : {window_low.x - 0.5, window_high.x + 0.5}) {
    stage.ellipsoid({{x, y, z}}, dvec3(0.03), 0.012, Material{.colour = {0.70, 0.53, 0.26}, .gloss = 3.0});
  }
}

}  // namespace binosplat::demo::room
