#include <algorithm>
#include <cmath>

#include "demo/demo.h"
#include "demo/light.h"
#include "demo/room_parts.h"

namespace binosplat {

namespace {

using namespace demo;

/// Late afternoon: a low sun through the window, and the lamp is on.
Lighting evening_light() {
  Lighting light{.to_sun = glm::normalize(dvec3(-0.42, -0.43, 0.84)), .haze_distance = 250.0};
  light.sun = {1.5, 1.2, 0.8};
  light.sky = {0.40, 0.42, 0.44};
  light.bounce = {0.20, 0.18, 0.12};
  light.room = {.low = room_low, .high = room_high, .sun = {5.0, 3.6, 2.1}, .ambient = {0.24, 0.21, 0.20}};
  light.room->lamps = {{lamp_bulb + 0.03 * down, {0.62, 0.42, 0.22}}};
  const dvec2 size = window_high - window_low;
  for (int k = 0; k < 12; ++k) {  // the sky in the window
    const dvec2 at = window_low + size * dvec2((k % 4 + 0.5) / 4.0, (std::floor(k / 4.0) + 0.5) / 3.0);
    light.room->lamps.push_back(
        {{at.x, at.y, room_high.z}, dvec3(0.54, 0.59, 0.64) * (size.x * size.y / 12.0), away});
  }
  return light;
}

Material meadow(double u, double v) {
  const double tuft = fractal(0.30 * u, 0.12 * v), path = std::abs(u - 149.0 - 3.0 * circle(v / 70.0).y);
  if (path < 1.2) return {.colour = mix({0.78, 0.68, 0.50}, {0.68, 0.58, 0.42}, tuft)};
  return {.colour = mix(dvec3(0.34, 0.46, 0.22), dvec3(0.60, 0.60, 0.34), ramp(0.25, 0.75, tuft))};
}

void add_outside(SceneBuilder& stage, const dvec3& to_sun) {
  add_sky(stage, {420.0, 0.09, to_sun, 3.0, [](const dvec3& d) { return d.z > 0.2 && d.y > -0.72; }});
  const dmat3 axes = axes_from_normal(-to_sun, down);
  stage.disc(405.0 * to_sun, axes, {7, 7, 1}, {.colour = {3.0, 2.8, 2.3}, .lit = false});
  stage.disc(400.0 * to_sun, axes, {26, 26, 1}, {.colour = {1.5, 1.25, 0.9}, .opacity = 0.45, .lit = false});
  stage.sheet({-150.0, 3.0, 3.0}, 300.0 * right, 160.0 * away, meadow, Grain(0.25));
  const dvec2 places[] = {{-5.5, 19.0}, {-11.0, 32.0}, {4.0, 40.0}, {9.0, 57.0}};
  for (int k = 0; k < 4; ++k) {
    const dvec3 foot(places[k].x, 3.0, places[k].y);
    add_tree(stage, foot, 2.5 + 0.2 * k, mix({0.36, 0.42, 0.16}, {0.28, 0.38, 0.15}, hash(k, 2)), 0.07);
  }
}

constexpr dvec3 room_size = room_high - room_low;
constexpr dvec2 rug_half{1.3, 0.9};

void add_floor(SceneBuilder& stage) {
  constexpr double plank = 0.15, gap = 0.006;
  for (int k = 0; k * plank < room_size.x; ++k) {
    const double x = room_low.x + k * plank, across = std::min(plank, room_high.x - x) - gap;
    const double joint = 2.0 * hash(k, 7);  // end of one board and start of the next
    const auto board = [=](double u, double v) {
      const double seed = k * 10 + std::floor((u + joint) / 2.0);
      Material wood = wooden({0.60, 0.41, 0.25}, seed, 3.5)(u, v);
      wood.colour *= 0.88 + 0.24 * hash_at(seed, 3);
      return wood;
    };
    stage.sheet({x, 0, room_high.z}, -room_size.z * away, across * right, board, {0.09, 0.036});
    stage.sheet({x + across, 0, room_high.z}, -room_size.z * away, gap * right,
                Material{.colour = {0.22, 0.14, 0.09}}, {0.08, gap});
  }
}

/// Returns the material of the rug at (x, y) from its middle.
Material woven(double x, double y) {
  const dvec3 red(0.52, 0.18, 0.17), navy(0.17, 0.21, 0.35), gold(0.78, 0.60, 0.32);
  const auto rings = [&](double at, double size, const dvec3& ground) {
    return at < 0.6 * size ? cream : at < size ? gold : ground;
  };
  const double from_x = rug_half.x - std::abs(x), from_y = rug_half.y - std::abs(y),
               edge = std::min(from_x, from_y);
  const double medallion = std::abs(x) / 0.80 + std::abs(y) / 0.52;
  const double stripe = part_of(medallion * 12.0 + 4.0 * std::abs(std::abs(x) - std::abs(y)), 1.0);
  dvec3 colour = rings(std::abs(std::remainder(x, 0.22)) + std::abs(std::remainder(y, 0.22)), 0.07, red);
  if (medallion < 0.80) colour = medallion > 0.72 ? gold : stripe < 0.3 ? cream : navy;
  if (medallion < 0.42) colour = rings(medallion, 0.32, 0.8 * red);
  if (edge < 0.26)
    colour =
        rings(std::abs(std::remainder(from_x < from_y ? y : x, 0.18)) + std::abs(edge - 0.17), 0.065, navy);
  if (edge < 0.05) colour = cream;
  return {.colour = colour * (0.9 + 0.2 * noise(70.0 * x, 70.0 * y))};
}

void add_rug(SceneBuilder& stage) {
  const dvec3 middle(0.15, 0.0, -0.25), half(rug_half.x, 0.0, rug_half.y);
  // Hides the floor under the rug, except at the rug's rim.
  stage.solid(Shape::box, middle - half + dvec3(0.06, -0.009, 0.06),
              middle + half + dvec3(-0.06, 0.02, -0.06));
  const auto look = [](double u, double v) { return woven(v - rug_half.x, rug_half.y - u); };
  stage.sheet(middle + dvec3(-half.x, -0.012, half.z), -2.0 * half.z * away, 2.0 * half.x * right, look,
              Grain(0.028), all_borders);
}

constexpr double panelling = 0.88;  // height, m

/// Returns painted boards between a skirting and a rail.
Material boarding(double u, double high) {
  const bool edge = std::abs(high - 0.12) < 0.012 || std::abs(high - 0.81) < 0.012;
  const bool groove = high > 0.13 && high < 0.80 && std::abs(std::remainder(u, 0.12)) < 0.015;
  return {.colour = white * (groove ? 0.80 : edge ? 0.70 : 1.0), .gloss = 0.3};
}

/// Returns wallpaper: a leaf in every cell of a brick-like lattice, in alternating directions.
Material wallpaper(double u, double high) {
  const dvec3 ground = mix(dvec3(0.30, 0.47, 0.47), dvec3(0.34, 0.52, 0.51), fractal(3.0 * u, 3.0 * high));
  const double row = std::floor(high / 0.36), odd = part_of(row, 2.0), sway = odd - 0.5;
  const double x = std::remainder(u + 0.19 * odd, 0.38), y = high - (row + 0.5) * 0.36;
  const double across = std::abs(x - sway * y - 1.5 * y * y * sway), along = y / 0.165;
  const double leaf = 0.075 * std::sqrt(std::max(0.0, 1.0 - along * along)) * (1.0 - 0.35 * along);
  const bool vein = across < 0.012 || std::abs(std::remainder(y - 0.6 * across, 0.07)) < 0.012;
  return {.colour = across < leaf && !vein ? mix(ground, dvec3(0.84, 0.79, 0.60), 0.70) : ground};
}

Material plaster(double u, double high) {
  return {.colour = dvec3(0.88, 0.80, 0.66) * (0.94 + 0.12 * fractal(2.0 * u, 2.0 * high))};
}

void add_walls(SceneBuilder& stage) {
  const dvec3 high = room_size.y * up, mouldings = panelling * up;
  const auto with_window = [](double u, double v) {
    const dvec2 at(room_low.x + u, -v);
    const bool window = glm::clamp(at, window_low, window_high) == at;
    return window ? Material{.opacity = 0.0} : v < panelling ? boarding(u, v) : wallpaper(u, v);
  };
  stage.sheet({room_low.x, 0, room_high.z}, room_size.x * right, high, with_window, {0.03, 0.03});
  stage.sheet({room_low.x, 0, room_low.z}, room_size.z * away, mouldings, boarding, {0.03, 0.04});
  stage.sheet({room_low.x, -panelling, room_low.z}, room_size.z * away, high - mouldings, plaster,
              Grain(0.08));
  const auto brickwork = [](double u, double v) {  // four rows of Gaussians a course
    const dvec3 colour = bricks(u, v * 37.0 * 0.075 / room_size.y, {0.62, 0.34, 0.25}, {0.88, 0.82, 0.74});
    return Material{.colour = colour * (0.88 + 0.24 * fractal(40.0 * u, 40.0 * v))};
  };
  stage.sheet({room_high.x, 0, room_high.z}, -room_size.z * away, high, brickwork,
              {0.085, room_size.y / 148.0});
  stage.sheet({room_high.x, 0, room_low.z}, -room_size.x * right, high, plaster, {0.1, 0.1});
  stage.sheet(room_low, room_size.z * away, room_size.x * right, Material{white}, Grain(0.14));
  // Solids around the room, with a hole for the window.
  const dvec3 low = room_low - 0.2, top = room_high + 0.2;
  stage.solid(Shape::box, low, {top.x, room_low.y, top.z});
  stage.solid(Shape::box, {low.x, 0.0, low.z}, top);
  stage.solid(Shape::box, low, {room_low.x, top.y, top.z});
  stage.solid(Shape::box, {room_high.x, low.y, low.z}, top);
  stage.solid(Shape::box, low, {top.x, top.y, room_low.z});
  stage.solid(Shape::box, {low.x, low.y, room_high.z}, {window_low.x, 0.0, top.z});
  stage.solid(Shape::box, {window_high.x, low.y, room_high.z}, {top.x, 0.0, top.z});
  stage.solid(Shape::box, {low.x, low.y, room_high.z}, {top.x, window_low.y, top.z});
  stage.solid(Shape::box, {low.x, window_high.y, room_high.z}, {top.x, 0.0, top.z});
}

void add_window(SceneBuilder& stage) {
  const auto bar = [&](const dvec3& low, const dvec3& high) {
    stage.solid_box(low, high, {0.07, 0.028}, Material{.colour = {0.95, 0.94, 0.91}, .gloss = 0.5});
  };
  const double front = room_high.z - 0.02, back = room_high.z + 0.14, z = room_high.z + 0.06;
  const dvec2 l = window_low, h = window_high;
  // Reveal, casing, and the sill below.
  bar({l.x - 0.08, l.y - 0.08, front}, {h.x + 0.08, l.y, back});
  bar({l.x - 0.08, l.y, front}, {l.x, h.y, back});
  bar({h.x, l.y, front}, {h.x + 0.08, h.y, back});
  bar({l.x - 0.12, h.y, front - 0.12}, {h.x + 0.12, h.y + 0.04, back});
  // Sashes: posts and crossbars.
  for (int i = 0; i <= 3; ++i) {
    const double x = l.x + (h.x - l.x) * i / 3.0;
    bar({std::max(x - 0.028, l.x), l.y, z}, {std::min(x + 0.028, h.x), h.y, z + 0.05});
  }
  for (const double y : {l.y, l.y + 0.52, h.y - 0.05}) bar({l.x, y, z}, {h.x, y + 0.05, z + 0.05});
  // Panes: nearly transparent, but they reflect the lights.
  const Material glass{.colour = {0.75, 0.84, 0.86}, .opacity = 0.05, .gloss = 2.0, .sharpness = 12};
  stage.sheet({l.x, h.y, z + 0.025}, (h.x - l.x) * right, (l.y - h.y) * down, glass, Grain(0.09));
}

void add_curtains(SceneBuilder& stage) {
  const Material cloth{.colour = {0.93, 0.86, 0.74}, .opacity = 0.72, .two_sided = true};
  constexpr double fold = 0.024;
  for (const double left : {window_low.x - 0.40, window_high.x - 0.06}) {
    for (int k = 0; k < 19; ++k) {
      const double z[] = {0.0, fold, 0.0, -fold};
      const dvec3 hem(left + fold * k, -0.05, room_high.z - 0.12 + z[k % 4]);
      stage.sheet(hem, {fold, 0.0, z[(k + 1) % 4] - z[k % 4]}, 2.46 * up, cloth, {0.012, 0.09});
    }
  }
  const double y = window_low.y - 0.16, z = room_high.z - 0.12;
  stage.tube({{window_low.x - 0.5, y, z}, {window_high.x + 0.5, y, z}}, 0.013, 0.012, brass);
}

/// The grain is a metre in the room, and grows with the distance outside.
double room_grain(const dvec3& place, double coarseness) {
  return coarseness * (1.0 + std::max(0.0, glm::length(place) - 5.0) / 4.0);
}

}  // namespace

std::vector<Camera> room_cameras() {
  return {head_of("room", {-0.95, -1.45, -1.75}, {0.30, -0.98, 1.0}, 62.0),
          head_of("window", {0.62, -1.08, -0.75}, {-0.70, -1.35, 2.0}, 60.0),
          head_of("table", {0.10, -1.25, -0.35}, {1.10, -0.80, 0.60}, 55.0)};
}

Demo demo_room() {
  const Lighting light = evening_light();
  SceneBuilder stage(room_grain);
  add_floor(stage);
  add_rug(stage);
  add_walls(stage);
  add_window(stage);
  add_curtains(stage);
  add_outside(stage, light.to_sun);
  add_furniture(stage);
  Demo demo{bake(stage, light, 3, demo_room_name), room_cameras()};
  // Removes Gaussians inside boxes. Otherwise a wall's Gaussians, if their centres are nearer, show through
  // things close in front of the wall.
  std::vector<std::uint8_t> kept;
  for (std::size_t i = 0; i < demo.model.count(); ++i)
    kept.push_back(demo.model.opacity[i] > 0.0f && !stage.solids.hide(demo.model.position[i]));
  keep_only(demo.model, kept);
  demo.model.left_out = 0;
  return demo;
}

}  // namespace binosplat
