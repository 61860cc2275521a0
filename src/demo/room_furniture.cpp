// Furniture and smaller things of demo:room.
#include <algorithm>
#include <cmath>

#include "demo/room_parts.h"

namespace binosplat::demo {

namespace {

/// Returns turned or bent wood, with its grain along v, the length along a tube or a profile; u is an angle.
Texture round_wood(const dvec3& colour) {
  return [flat = wooden(colour, 3)](double a, double v) { return flat(v, 0.02 * circle(a / (2.0 * pi)).y); };
}

void add_table(SceneBuilder& stage) {
  stage.frame = {{0.95, 0, 0.5}};
  constexpr double radius = 0.55, top = -0.74;
  const auto plate = [=, wood = wooden(walnut, 8, 4.0)](double angle, double v) {
    // The boards of the top run straight across it.
    const dvec2 p = std::min(v, radius) * circle(angle / (2.0 * pi));
    Material board = wood(p.x + 7.0 * std::floor(p.y / 0.11), p.y);
    if (std::abs(std::remainder(p.y, 0.11)) < 0.006 && v < radius) board.colour *= 0.7;
    return board;
  };
  stage.lathe({}, {{0.0, top}, {radius, top}, {radius, top + 0.035}, {0.5, top + 0.035}}, 0.021, plate);
  stage.solid(Shape::ellipsoid, {-radius, top, -radius}, {radius, top + 0.035, radius});
  stage.lathe({}, {{0.055, -0.7}, {0.08, -0.5}, {0.05, -0.35}, {0.07, -0.1}, {0.22, -0.03}, {0.24, 0.0}},
              0.02, round_wood(walnut));
  stage.solid(Shape::ellipsoid, {-0.055, top, -0.055}, {0.055, -0.05, 0.055});
  stage.solid(Shape::ellipsoid, {-0.2, -0.05, -0.2}, {0.2, 0.0, 0.2});
}

void add_chair(SceneBuilder& stage, const dvec3& foot, double degrees) {  // the sitter looks towards low z
  stage.frame = turned(foot, degrees);
  constexpr double seat = -0.45;
  stage.solid_box({-0.21, seat, -0.20}, {0.21, seat + 0.03, 0.20}, {0.05, 0.025}, wooden(oak, 11));
  stage.ellipsoid({0, seat - 0.012, 0}, {0.19, 0.03, 0.18}, 0.018, [](double a, double) {
    return Material{std::abs(std::remainder(a, pi / 6.0)) < 0.08 ? cream : dvec3(0.28, 0.42, 0.52)};
  });
  for (const dvec2 at : {dvec2(-1, -1), dvec2(1, -1), dvec2(-1, 1), dvec2(1, 1)}) {
    const double x = 0.19 * at.x, z = 0.18 * at.y;
    stage.tube({{0.9 * x, seat + 0.03, 0.9 * z}, {1.1 * x, 0, 1.1 * z}}, 0.016, 0.03, round_wood(oak));
  }
  // A back of thin spindles under a bent rail.
  for (int k = 0; k < 7; ++k) {
    const double x = -0.17 + 0.34 * k / 6.0, bend = 0.04 * (1.0 - x * x / 0.04);
    stage.wire({{x, seat, 0.17}, {1.08 * x, -0.88, 0.25 + bend}}, 0.007, 0.03, {.colour = oak, .gloss = 0.6});
  }
  stage.tube({{-0.21, -0.86, 0.22}, {0, -0.90, 0.285}, {0.21, -0.86, 0.22}}, 0.020, 0.02, round_wood(oak));
}

void add_armchair(SceneBuilder& stage) {  // the sitter looks towards low z
  stage.frame = turned({-1.72, 0, 0.95}, 35.0);
  const auto cloth = [](double u, double v) {
    return Material{.colour = dvec3(0.80, 0.56, 0.18) * (0.90 + 0.2 * noise(90.0 * u, 90.0 * v))};
  };
  const auto part = [&](const dvec3& low, const dvec3& high) {
    stage.solid_box(low, high, Grain(0.036), cloth);
  };
  const auto roll = [&](const dvec3& from, const dvec3& to, double radius) {  // a rounded edge
    stage.tube({from, to}, radius, 0.028, cloth);
    for (const dvec3& end : {from, to}) stage.ellipsoid(end, dvec3(radius), 0.028, cloth);
  };
  part({-0.32, -0.36, -0.36}, {0.32, -0.10, 0.30});
  stage.ellipsoid({0, -0.38, -0.04}, {0.31, 0.09, 0.33}, 0.028, cloth);
  part({-0.40, -0.88, 0.26}, {0.40, -0.08, 0.40});
  roll({-0.39, -0.90, 0.33}, {0.39, -0.90, 0.33}, 0.08);
  for (const double x : {-0.36, 0.36}) {
    part({x - 0.06, -0.52, -0.38}, {x + 0.06, -0.08, 0.34});
    roll({1.03 * x, -0.54, -0.34}, {1.03 * x, -0.54, 0.32}, 0.085);
    for (const double z : {-0.32, 0.34})
      stage.tube({{x, -0.10, z}, {x, 0, z}}, 0.022, 0.03, round_wood(walnut));
  }
  stage.ellipsoid({0.08, -0.58, 0.16}, {0.20, 0.19, 0.08}, 0.018, [](double a, double) {
    return Material{std::abs(std::remainder(a, pi / 4.0)) < 0.2 ? dvec3(0.20, 0.40, 0.44) : cream};
  });
}

/// Returns the spines of books on a shelf of this height, `u` m along the shelf and `v` m above it.
Material books_at(int shelf, double height, double u, double v) {
  const double warped = u / 0.036 + 0.7 * noise(11.0 * u, shelf), book = std::floor(warped) + 100.0 * shelf;
  const auto lot = [&](double which) { return hash_at(book, which); };
  const double tall = height * (0.62 + 0.28 * lot(2)), edge = std::abs(part_of(warped, 1.0) - 0.5);
  if (v > tall || edge > 0.46 || lot(1) < 0.06) return {.colour = {0.13, 0.09, 0.06}};
  const dvec3 dye = 0.38 + 0.16 * dvec3(circle(lot(4)).x, circle(lot(4) + 0.37).x, circle(lot(4) + 0.7).x);
  const bool band = std::abs(v / tall - 0.15 - 0.5 * lot(3)) < 0.07 || std::abs(v / tall - 0.9) < 0.03;
  const dvec3 cover = dye * ((0.65 + 0.65 * lot(5)) * (1.0 - 0.6 * edge * edge));
  return {.colour = band ? mix(cover, {0.92, 0.82, 0.55}, 0.7) : cover, .gloss = 0.5};
}

void add_bookshelf(SceneBuilder& stage) {
  constexpr double x0 = 2.18, x1 = 2.48, z0 = 0.55, z1 = 1.75, top = -2.05, board = 0.025, shelves = 5.0;
  const Texture plank = wooden({0.46, 0.30, 0.19}, 31);
  const auto part = [&](const dvec3& low, const dvec3& high) {
    stage.solid_box(low, high, {0.07, 0.03}, plank);
  };
  part({x0, top, z0 - board}, {x1, 0, z0});
  part({x0, top, z1}, {x1, 0, z1 + board});
  for (int shelf = 0; shelf <= 5; ++shelf) {
    const double room = -(top + 0.06) / shelves, y = -0.06 - room * shelf;
    part({x0, y, z0}, {x1, y + board, z1});
    if (shelf == 5) break;
    const auto spines = [=](double u, double v) { return books_at(shelf, room - board, u, v); };
    stage.sheet({x0 + 0.05, y, z1}, (z0 - z1) * away, (room - board) * up, spines, {0.014, 0.03});
    stage.solid(Shape::box, {x0 + 0.06, y - room, z0}, {x1, y, z1});
  }
}

void add_lamp(SceneBuilder& stage) {
  stage.frame = {lamp_bulb};
  const double ceiling = room_low.y - lamp_bulb.y;
  stage.wire({{0, ceiling, 0}, {0, -0.22, 0}}, 0.004, 0.02, {.colour = {0.12, 0.11, 0.10}});
  // The shade glows from inside.
  const auto shade = [](double angle, double) {
    const double rib = 0.9 + 0.1 * circle(16.0 * angle / (2.0 * pi)).x;
    return Material{
        .colour = rib * dvec3(0.96, 0.80, 0.52), .opacity = 0.93, .glow = 0.16, .two_sided = true};
  };
  stage.lathe({}, {{0.05, -0.20}, {0.09, -0.17}, {0.19, -0.04}, {0.25, 0.08}}, 0.017, shade);
  stage.lathe({}, {{0.02, -0.23}, {0.035, -0.22}, {0.05, -0.195}}, 0.012, brass);
  stage.ellipsoid({}, {0.045, 0.055, 0.045}, 0.012, Material{.colour = {1.0, 0.95, 0.82}, .glow = 6.0});
}

/// Returns the painting's colour; x and y run from 0 to 1, y upwards.
dvec3 evening_by_the_sea(double x, double y) {
  if (y < 0.34) {
    const double glitter = 0.7 / (1.0 + 60.0 * (x - 0.62) * (x - 0.62)) + 0.25 * noise(9.0 * x, 50.0 * y);
    return mix({0.16, 0.26, 0.40}, {0.86, 0.58, 0.36}, glitter);
  }
  if (glm::length(dvec2(1.5 * (x - 0.62), y - 0.45)) < 0.11) return {1.0, 0.90, 0.62};
  return mix({0.95, 0.62, 0.36}, {0.30, 0.36, 0.56}, ramp(0.34, 1.0, y + 0.15 * fractal(3.0 * x, 7.0 * y)));
}

/// Hangs a picture behind glass; `corner` is its lower left one.
void hang(SceneBuilder& stage, const dvec3& corner, const dvec3& u, const dvec2& size) {
  stage.frame = {corner, dmat3(u, down, glm::cross(u, down))};  // z into the wall
  stage.solid(Shape::box, {0, -size.y, -0.01}, {size.x, 0, 0.02});
  const auto painting = [=](double a, double b) {
    const double edge = std::min({a, size.x - a, b, size.y - b}), x = a / size.x, y = b / size.y;
    const dvec3 colour = edge < 0.03 ? walnut : edge < 0.08 ? cream : evening_by_the_sea(x, y);
    return Material{.colour = colour, .gloss = 2.0, .sharpness = 14};
  };
  stage.sheet({0, 0, -0.02}, size.x * right, size.y * up, painting, Grain(0.015), all_borders);
}

constexpr double table_top = -0.74;

/// Adds a leaf that starts at `from`, runs `along` and bends down; its upper side faces up.
void add_leaf(SceneBuilder& stage, const dvec3& from, const dvec3& along, const dvec2& size,
              const dvec3& colour) {
  constexpr double spacing = 0.006;
  const int pieces = static_cast<int>(size.x / spacing);
  const dvec3 side = glm::normalize(glm::cross(along, down));
  for (int i = 0; i < pieces; ++i) {
    const double t = (i + 0.5) / pieces, half = size.y * std::sqrt(t * (1.0 - t) * (1.2 - 0.4 * t));
    const dvec3 rib = from + size.x * (t * along + 0.45 * t * t * down);
    const dvec3 forward = glm::normalize(along + 0.9 * t * down);
    const int across = std::max(1, static_cast<int>(std::lround(half / spacing)));
    for (int k = -across; k <= across; ++k) {
      const double s = k / (across + 0.5);
      const dvec3 normal = glm::normalize(glm::cross(forward, side) + 0.45 * glm::sign(s) * side);
      const dvec3 shade =
          k == 0 ? mix(colour, {0.80, 0.86, 0.52}, 0.45) : colour * (0.9 + 0.2 * noise(60.0 * t, 5.0 * s));
      stage.disc(rib + s * half * (side + 0.35 * std::abs(s) * up), axes_from_normal(normal, forward),
                 {0.75 * size.x / pieces, std::max(0.0012, 0.7 * half / (across + 0.5)), 0.0006},
                 {.colour = shade, .gloss = 1.0, .sharpness = 10, .two_sided = true});
    }
  }
}

void add_tea(SceneBuilder& stage) {
  const Material china{.colour = {0.93, 0.93, 0.92}, .gloss = 2.5, .sharpness = 16};
  stage.frame = turned({0.82, table_top, 0.30}, 30.0);
  stage.lathe({},
              {{0, -0.165},
               {0.016, -0.152},
               {0.01, -0.145},
               {0.06, -0.135},
               {0.098, -0.075},
               {0.085, -0.025},
               {0.05, 0}},
              0.009, [=](double a, double v) {
                const bool flower = std::abs(v - 0.15) < 0.014 && circle(6.0 * a / (2.0 * pi)).x > 0.55;
                Material look = china;
                if (std::abs(v - 0.115) < 0.010 || flower) look.colour = {0.16, 0.28, 0.56};
                return look;
              });
  stage.solid(Shape::ellipsoid, {-0.095, -0.14, -0.095}, {0.095, 0.005, 0.095});
  stage.tube({{0.075, -0.045, 0}, {0.115, -0.065, 0}, {0.16, -0.13, 0}}, 0.013, 0.008, china);
  stage.tube({{-0.08, -0.11, 0}, {-0.14, -0.12, 0}, {-0.14, -0.06, 0}, {-0.08, -0.035, 0}}, 0.008, 0.008,
             china);
  stage.frame = {{1.02, table_top, 0.12}};
  stage.lathe({}, {{0.043, -0.062}, {0.040, -0.030}, {0.022, -0.006}, {0.072, -0.014}}, 0.008, china);
  stage.lathe({}, {{0.0, -0.048}, {0.040, -0.048}}, 0.010,
              Material{.colour = {0.2, 0.1, 0.03}, .gloss = 2.0});
}

void add_flowers(SceneBuilder& stage) {
  stage.frame = {{1.16, table_top, 0.58}};
  const Material glass{.colour = {0.72, 0.86, 0.86}, .opacity = 0.11, .gloss = 5.0, .sharpness = 20};
  const Material water{.colour = {0.70, 0.84, 0.82}, .opacity = 0.22, .gloss = 4.0};
  const dvec3 green(0.30, 0.46, 0.20),
      colours[] = {{0.93, 0.55, 0.60}, {0.98, 0.86, 0.55}, {0.88, 0.36, 0.4}};
  stage.lathe({}, {{0.055, -0.26}, {0.040, -0.22}, {0.072, -0.09}, {0.068, -0.03}, {0.0, 0.0}}, 0.011, glass);
  stage.lathe({}, {{0.0, -0.13}, {0.058, -0.13}}, 0.012, water);
  for (int k = 0; k < 9; ++k) {
    const dvec3 out(circle(0.382 * k).x, 0.0, circle(0.382 * k).y), neck = 0.02 * out + 0.24 * up;
    const dvec3 head = (0.065 + 0.12 * hash(k, 2)) * out + (0.36 + 0.14 * hash(k, 3)) * up;
    stage.wire({-0.025 * out + 0.02 * up, neck, head}, 0.0022, 0.016, {.colour = green});
    if (k % 2 == 0) add_leaf(stage, mix(neck, head, 0.4), {-out.z, -0.5, out.x}, {0.09, 0.03}, green);
    for (int petal = 0; petal < 16; ++petal) {  // two rings around a yellow middle
      const dvec2 c = circle(petal / 8.0 + (petal < 8 ? 0.0 : 0.06));
      const dvec3 outwards = glm::normalize(dvec3(c.x, petal < 8 ? -0.35 : -0.9, c.y));
      stage.disc(head + 0.018 * outwards,
                 axes_from_normal(glm::cross(outwards, dvec3(-c.y, 0, c.x)), outwards), {0.011, 0.007, 0.001},
                 {.colour = colours[k % 3] * (0.86 + 0.2 * hash(petal, k)), .two_sided = true});
    }
    stage.ellipsoid(head + 0.006 * up, dvec3(0.008), 0.007, Material{.colour = {0.93, 0.74, 0.22}});
  }
}

void add_bird_cage(SceneBuilder& stage) {
  constexpr double radius = 0.17;
  stage.frame = {{0.02, -1.52, 1.30}};  // the middle of its floor
  const auto at = [&](double turn, const dvec2& place) {
    return dvec3(radius * place.x * circle(turn).x, place.y, radius * place.x * circle(turn).y);
  };
  stage.lathe({}, {{0.0, -0.03}, {radius, -0.03}, {radius + 0.005, 0.0}, {0.0, 0.0}}, 0.018, brass);
  for (int k = 0; k < 24; ++k) {
    std::vector<dvec3> bar{at(k / 24.0, {1.0, 0.0})};
    for (int j = 0; j <= 6; ++j)
      bar.push_back(at(k / 24.0, circle(j / 24.5) * dvec2(1.0, -0.17) - dvec2(0, 0.26)));
    stage.wire(bar, 0.0018, 0.018, brass);
  }
  for (const dvec2 ring : {dvec2(1.0, -0.13), dvec2(1.0, -0.26), dvec2(0.80, -0.36)}) {
    std::vector<dvec3> path;
    for (int k = 0; k <= 48; ++k) path.push_back(at(k / 48.0, ring));
    stage.wire(path, 0.0025, 0.02, brass);
  }
  stage.wire({{0, -0.43, 0}, {0, room_low.y + 1.52, 0}}, 0.003, 0.02, {.colour = {0.30, 0.26, 0.20}});
  stage.wire({{-radius, -0.12, 0}, {radius, -0.12, 0}}, 0.005, 0.02, {.colour = {0.50, 0.34, 0.20}});
  stage.ellipsoid({0.02, -0.16, 0}, {0.05, 0.03, 0.03}, 0.009, Material{{0.96, 0.80, 0.20}});  // a bird
  stage.ellipsoid({0.06, -0.195, 0}, dvec3(0.022), 0.007, Material{{0.96, 0.80, 0.20}});
}

void add_fairy_lights(SceneBuilder& stage) {
  const dvec3 colours[] = {{1.0, 0.72, 0.36}, {0.95, 0.36, 0.30}, {0.45, 0.75, 0.55}, {0.45, 0.62, 0.92}};
  std::vector<dvec3> cable;
  for (int k = 0; k <= 68; ++k) {
    const double wave = circle(1.5 * k / 68.0).y;
    cable.push_back(mix({room_low.x, -2.50, -0.55}, {room_high.x, -2.45, 1.2}, k / 68.0) +
                    0.07 * wave * wave * down);
    if (k % 4 != 2) continue;
    const dvec3 at = cable.back() + 0.028 * down, colour = colours[k / 4 % 4];
    stage.ellipsoid(at, {0.016, 0.024, 0.016}, 0.009,
                    Material{.colour = colour, .opacity = 0.92, .glow = 2.5});
  }
  stage.wire(cable, 0.003, 0.04, {.colour = {0.16, 0.18, 0.14}});
}

void add_toys(SceneBuilder& stage) {
  const dvec3 colours[] = {{0.90, 0.24, 0.20}, {0.20, 0.44, 0.76}, {0.96, 0.76, 0.20}, {0.36, 0.58, 0.34}};
  stage.frame = turned({-0.62, -0.12, 0.62}, 25.0, 20.0);
  stage.ellipsoid({}, dvec3(0.12), 0.012, [&](double a, double b) {
    const int slice = static_cast<int>(3.0 * part_of(a / pi + 0.9, 2.0));
    const bool coloured = std::abs(b) < 1.35 && slice % 2 == 0;
    return Material{.colour = coloured ? colours[slice / 2] : white, .gloss = 2.0, .sharpness = 16};
  });
  stage.solid(Shape::ellipsoid, dvec3(-0.118), dvec3(0.118));
  for (int k = 0; k < 4; ++k) {  // wooden blocks
    stage.frame = turned({0.11 * k - 0.66, -0.012, 0.12 + 0.02 * (k % 2)}, 17.0 * k);
    stage.solid_box({-0.04, -0.08, -0.04}, {0.04, -0.001, 0.04}, Grain(0.013), Material{colours[k]});
  }
}

void add_near_plant(SceneBuilder& stage) {
  stage.frame = {{-1.46, -0.95, -1.16}};
  const Material earth{{0.24, 0.17, 0.12}}, clay{.colour = {0.76, 0.42, 0.28}, .gloss = 0.4};
  stage.lathe({}, {{0.0, -0.17}, {0.11, -0.17}, {0.115, -0.15}, {0.10, -0.145}, {0.075, 0.0}}, 0.014,
              [=](double, double v) { return v < 0.10 ? earth : clay; });
  // A tall stand.
  stage.lathe({}, {{0.0, 0.0}, {0.14, 0.0}, {0.14, 0.02}, {0.03, 0.04}, {0.02, 0.90}, {0.14, 0.95}}, 0.02,
              round_wood(walnut));
  stage.solid(Shape::ellipsoid, {-0.12, -0.17, -0.12}, {0.12, 0.02, 0.12});
  // Leaves on thin stems; the nearest one is within the viewer's reach.
  for (int k = 0; k < 22; ++k) {
    const dvec3 outwards(circle(0.382 * k).x, 0, circle(0.382 * k).y), root = 0.17 * up + 0.02 * outwards;
    const dvec3 joint = (0.29 + 0.30 * hash(k, 91)) * up + (0.10 + 0.16 * hash(k, 92)) * outwards;
    const dvec3 green = mix({0.16, 0.36, 0.15}, {0.40, 0.56, 0.22}, hash(k, 93));
    stage.wire({root, mix(root, joint, 0.5) + 0.05 * up, joint}, 0.0025, 0.012,
               {.colour = {0.36, 0.50, 0.22}});
    add_leaf(stage, joint, glm::normalize(outwards + 0.15 * up), {0.13 + 0.06 * hash(k, 94), 0.055}, green);
  }
}

}  // namespace

Texture wooden(const dvec3& colour, double seed, double gloss) {
  return [=](double u, double v) {
    const double grain = fractal(2.0 * u + 13.0 * seed, 50.0 * v + 31.0 * seed);
    return Material{.colour = colour * (0.78 + 0.44 * grain), .gloss = gloss, .sharpness = 13};
  };
}

void add_furniture(SceneBuilder& stage) {
  add_bookshelf(stage);
  add_fairy_lights(stage);
  add_table(stage);
  add_chair(stage, {0.42, 0, 0.98}, 50.0);
  add_chair(stage, {1.62, 0, 0.05}, -130.0);
  add_armchair(stage);
  add_lamp(stage);
  hang(stage, {0.92, -1.25, room_high.z}, right, {0.48, 0.62});
  hang(stage, {1.50, -1.34, room_high.z}, right, {0.46, 0.46});
  hang(stage, {room_low.x, -1.12, -0.75}, away, {1.3, 0.85});
  add_tea(stage);
  add_flowers(stage);
  add_bird_cage(stage);
  add_toys(stage);
  add_near_plant(stage);
  stage.frame = {};
}

}  // namespace binosplat::demo
