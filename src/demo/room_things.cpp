// demo:room: what stands, hangs and lies about.
#include <algorithm>
#include <cmath>

#include "demo/room_parts.h"

namespace binosplat::demo::room {

namespace {

constexpr double table_top = -0.74;

struct Leaf {
  double length, width, grain;
  dvec3 colour;
};

/// A leaf that starts at `from`, leads `along` and bends down; its upper side faces up.
void add_leaf(Stage& stage, const dvec3& from, const dvec3& along, const Leaf& leaf) {
  const double length = leaf.length, grain = leaf.grain;
  const dvec3 tip = from + length * (along + dvec3(0, 0.45, 0));
  const std::vector<dvec3> rib = curve({from, from + 0.5 * length * along, tip}, grain);
  for (std::size_t i = 0; i + 1 < rib.size(); ++i) {
    const double t = (static_cast<double>(i) + 0.5) / static_cast<double>(rib.size() - 1);
    const dvec3 forward = glm::normalize(rib[i + 1] - rib[i]);
    const dvec3 side = glm::normalize(glm::cross(forward, dvec3(0, 1, 0)));
    const double half = 0.5 * leaf.width * std::sqrt(std::sin(pi * std::pow(t, 0.75)));
    const int across = std::max(1, static_cast<int>(std::lround(half / grain)));
    for (int k = -across; k <= across; ++k) {
      const double s = static_cast<double>(k) / (across + 0.5);
      const dvec3 p = 0.5 * (rib[i] + rib[i + 1]) + s * half * (side - dvec3(0, 0.35 * std::abs(s), 0));
      const dvec3 normal = glm::normalize(glm::cross(side, forward) + 0.45 * glm::sign(-s) * side);
      const dvec3 up = normal.y < 0 ? normal : -normal;
      const dvec3 shade = k == 0 ? mix(leaf.colour, {0.80, 0.86, 0.52}, 0.45)
                                 : leaf.colour * (0.9 + 0.2 * noise(60.0 * t, 5.0 * s));
      const double sigma = 0.7 * half / (across + 0.5);
      stage.disc(p, axes_from_normal(up, forward), {0.75 * grain, std::max(0.0012, sigma), 0.0006},
                 {.colour = shade, .gloss = 1.0, .sharpness = 10, .two_sided = true});
    }
  }
}

void add_teapot(Stage& stage) {
  const Frame frame = turned({0.82, table_top, 0.30}, 30.0);
  const auto china = [](double a, double v) {
    const bool band =
        std::abs(v - 0.115)<0.010, flower = std::cos(6.0 * a)> 0.55 && std::abs(v - 0.15) < 0.014;
    return Material{.colour = band || flower ? dvec3(0.16, 0.28, 0.56) : dvec3(0.93, 0.93, 0.92),
                    .gloss = 2.5,
                    .sharpness = 16};
  };
  const auto white = Material{.colour = {0.93, 0.93, 0.92}, .gloss = 2.5, .sharpness = 16};
  stage.group();
  stage.lathe(frame,
              {dvec2(0.0, -0.165), dvec2(0.012, -0.165), dvec2(0.016, -0.152), dvec2(0.010, -0.145),
               dvec2(0.045, -0.138), dvec2(0.052, -0.130), dvec2(0.085, -0.10), dvec2(0.098, -0.065),
               dvec2(0.085, -0.025), dvec2(0.055, -0.004), dvec2(0.0, 0.0)},
              0.009, china);
  stage.block(Shape::ellipsoid, frame, {-0.095, -0.14, -0.095}, {0.095, 0.005, 0.095});
  stage.tube(curve({frame.at(0.075, -0.045, 0), frame.at(0.115, -0.065, 0), frame.at(0.135, -0.11, 0),
                    frame.at(0.16, -0.13, 0)},
                   0.009),
             0.013, 0.008, white);
  stage.tube(curve({frame.at(-0.075, -0.11, 0), frame.at(-0.125, -0.125, 0), frame.at(-0.15, -0.085, 0),
                    frame.at(-0.125, -0.045, 0), frame.at(-0.08, -0.035, 0)},
                   0.009),
             0.008, 0.008, white);
  const Frame cup{{1.02, table_top, 0.12}};
  stage.lathe(cup,
              {dvec2(0.040, -0.060), dvec2(0.043, -0.062), dvec2(0.040, -0.030), dvec2(0.022, -0.006),
               dvec2(0.028, -0.004), dvec2(0.060, -0.010), dvec2(0.072, -0.014)},
              0.008, china);
  stage.lathe(cup, {{0.0, -0.048}, {0.036, -0.048}}, 0.010,
              Material{.colour = {0.42, 0.20, 0.07}, .gloss = 2.0});
  stage.block(Shape::cylinder, cup, {-0.04, -0.06, -0.04}, {0.04, 0, 0.04});
}

void add_glass_vase(Stage& stage) {
  const Frame frame{{1.16, table_top, 0.58}};
  const Material glass{.colour = {0.72, 0.86, 0.86}, .opacity = 0.11, .gloss = 5.0, .sharpness = 20};
  stage.lathe(frame,
              {dvec2(0.055, -0.26), dvec2(0.040, -0.22), dvec2(0.050, -0.16), dvec2(0.072, -0.09),
               dvec2(0.068, -0.03), dvec2(0.050, -0.005), dvec2(0.0, 0.0)},
              0.011, glass);
  stage.lathe(frame, {{0.0, -0.13}, {0.058, -0.13}}, 0.012,
              Material{.colour = {0.70, 0.84, 0.82}, .opacity = 0.22, .gloss = 4.0});
  const dvec3 colours[] = {
      {0.93, 0.55, 0.60}, {0.98, 0.86, 0.55}, {0.88, 0.36, 0.40}, {0.96, 0.93, 0.90}, {0.72, 0.52, 0.78}};
  for (int k = 0; k < 9; ++k) {
    const double angle = 2.4 * k, lean = 0.05 + 0.09 * hash(k, 2), tall = 0.36 + 0.14 * hash(k, 3);
    const dvec3 foot = frame.at(-0.025 * std::cos(angle), -0.02, -0.025 * std::sin(angle));
    const dvec3 head = frame.at(lean * std::cos(angle) * 1.3, -tall, lean * std::sin(angle) * 1.3);
    const dvec3 neck = frame.at(0.02 * std::cos(angle), -0.24, 0.02 * std::sin(angle));
    stage.wire(curve({foot, neck, head}, 0.02), 0.0022, 0.016, {.colour = {0.30, 0.46, 0.20}});
    if (k % 2 == 0)
      add_leaf(stage, mix(neck, head, 0.4),
               glm::normalize(dvec3(std::cos(angle + 1.0), -0.5, std::sin(angle + 1.0))),
               {0.09, 0.03, 0.010, {0.30, 0.46, 0.20}});
    const dvec3 colour = colours[k % 5];
    for (int petal = 0; petal < 24; ++petal) {  // two crowns of petals around a yellow middle
      const double turn = 2.0 * pi * petal / 12.0 + (petal >= 12 ? 0.26 : 0.0),
                   rise = petal >= 12 ? 0.9 : 0.35;
      const dvec3 outwards = glm::normalize(dvec3(std::cos(turn), -rise, std::sin(turn)));
      const dvec3 normal = glm::normalize(dvec3(-rise * std::cos(turn), -1.0, -rise * std::sin(turn)));
      stage.disc(head + 0.018 * outwards, axes_from_normal(normal, outwards), {0.011, 0.0055, 0.001},
                 {.colour = colour * (0.86 + 0.2 * hash(petal, k)), .two_sided = true});
    }
    stage.ellipsoid({head - dvec3(0, 0.006, 0)}, dvec3(0.008), 0.007, Material{.colour = {0.93, 0.74, 0.22}});
  }
}

void add_chessboard(Stage& stage) {
  const Frame frame = turned({1.22, table_top, 0.22}, -24.0);
  constexpr double field = 0.034;
  stage.box(frame, {-0.15, -0.018, -0.15}, {0.15, 0, 0.15}, Grain(field / 3.0), [](double u, double v) {
    const double x = u - 0.15, z = v - 0.15;
    if (std::max(std::abs(x), std::abs(z)) > 4.0 * field)
      return Material{.colour = {0.36, 0.20, 0.11}, .gloss = 1.5};
    const bool dark =
        ((static_cast<int>(std::floor(x / field)) + static_cast<int>(std::floor(z / field))) & 1) != 0;
    return Material{.colour = dark ? dvec3(0.30, 0.17, 0.10) : dvec3(0.90, 0.78, 0.56), .gloss = 1.5};
  });
  for (int k = 0; k < 14; ++k) {
    const bool white = k < 7;
    const double x = (std::floor(8.0 * hash(k, 61)) - 3.5) * field;
    const double z = ((white ? 0.0 : 5.0) + std::floor(3.0 * hash(k, 62)) - 3.5) * field;
    const double tall = 0.035 + 0.03 * hash(k, 63);
    const Frame foot{frame.at(x, -0.018, z)};
    stage.lathe(foot,
                {dvec2(0.0, -tall), dvec2(0.006, -tall + 0.002), dvec2(0.008, -tall + 0.008),
                 dvec2(0.005, -tall + 0.014), dvec2(0.005, -0.012), dvec2(0.012, -0.004), dvec2(0.012, 0.0)},
                0.006,
                Material{.colour = white ? dvec3(0.90, 0.82, 0.66) : dvec3(0.18, 0.11, 0.08), .gloss = 2.0});
  }
}

void add_fruit_bowl(Stage& stage) {
  stage.group();
  const Frame frame{{0.74, table_top, 0.70}};
  stage.lathe(frame, {{0.145, -0.075}, {0.150, -0.078}, {0.130, -0.035}, {0.080, -0.010}, {0.050, 0.0}},
              0.012, Material{.colour = {0.24, 0.46, 0.48}, .gloss = 2.5, .sharpness = 16});
  stage.lathe(frame, {{0.0, -0.022}, {0.075, -0.022}, {0.125, -0.045}, {0.143, -0.072}}, 0.015,
              Material{.colour = {0.80, 0.86, 0.82}});
  stage.block(Shape::cylinder, frame, {-0.13, -0.05, -0.13}, {0.13, 0, 0.13});
  const dvec3 colours[] = {{0.94, 0.55, 0.14}, {0.78, 0.18, 0.14}, {0.94, 0.60, 0.16},
                           {0.60, 0.68, 0.22}, {0.92, 0.52, 0.12}, {0.80, 0.22, 0.16}};
  for (int k = 0; k < 6; ++k) {
    const double angle = 2.0 * pi * k / 5.0, ring = k == 5 ? 0.0 : 0.072;
    const Frame fruit{frame.at(ring * std::cos(angle), k == 5 ? -0.120 : -0.068, ring * std::sin(angle))};
    stage.ellipsoid(fruit, {0.040, 0.037, 0.040}, 0.010, [&](double a, double b) {
      return Material{
          .colour = colours[k] * (0.92 + 0.16 * noise(9.0 * a, 9.0 * b)), .gloss = 1.5, .sharpness = 12};
    });
    stage.block(Shape::ellipsoid, fruit, dvec3(-0.036), dvec3(0.036));
  }
}

void add_bird(Stage& stage, const dvec3& perch) {
  const Frame body = rolled(turned(perch - dvec3(0, 0.045, 0), 11.0), -29.0);  // x leads from tail to breast
  const auto feathers = [](double a, double b) {
    return Material{.colour = dvec3(0.96, 0.80, 0.20) * (0.9 + 0.15 * noise(9.0 * a, 9.0 * b))};
  };
  stage.ellipsoid(body, {0.050, 0.032, 0.030}, 0.009, feathers);
  const dvec3 head = body.origin + dvec3(0.042, -0.045, 0.008);
  stage.ellipsoid({head}, dvec3(0.022), 0.007, feathers);
  stage.wire({head + dvec3(0.018, 0, 0.004), head + dvec3(0.036, 0.004, 0.008)}, 0.005, 0.009,
             {.colour = {0.90, 0.45, 0.15}});
  for (int k = -1; k <= 1; ++k) {
    const dvec3 tail = body.at(-0.10, 0.01, 0.012 * k);
    stage.wire({body.at(-0.03, 0, 0), tail}, 0.007, 0.02, {.colour = {0.88, 0.70, 0.16}});
  }
  for (const double side : {-1.0, 1.0}) {
    stage.ellipsoid({head + dvec3(0.012, -0.006, 0.018 * side)}, dvec3(0.004), 0.004,
                    Material{.colour = {0.05, 0.05, 0.05}});
    const dvec3 foot = perch + dvec3(0, 0, 0.012 * side);
    stage.wire({foot - dvec3(0, 0.025, 0), foot}, 0.002, 0.012, {.colour = {0.80, 0.45, 0.25}});
  }
}

}  // namespace

void add_table_setting(Stage& stage) {
  add_teapot(stage);
  add_glass_vase(stage);
  add_chessboard(stage);
  add_fruit_bowl(stage);
}

void add_bird_cage(Stage& stage) {
  const dvec3 base(0.02, -1.52, 1.30);  // the middle of its floor
  constexpr double radius = 0.17, wall = 0.26;
  const Material gold{.colour = {0.66, 0.50, 0.24}, .gloss = 2.5};
  const Frame frame{base};
  stage.lathe(frame, {{0.0, -0.03}, {radius, -0.03}, {radius + 0.005, 0.0}, {0.0, 0.0}}, 0.018, gold);
  constexpr int bars = 24;
  for (int k = 0; k < bars; ++k) {
    const double angle = 2.0 * pi * k / bars, c = std::cos(angle), s = std::sin(angle);
    std::vector<dvec3> path;
    for (const dvec2 at :
         {dvec2(1.0, 0.0), dvec2(1.0, -wall), dvec2(0.92, -wall - 0.07), dvec2(0.70, -wall - 0.12),
          dvec2(0.38, -wall - 0.155), dvec2(0.03, -wall - 0.17)}) {
      path.push_back(frame.at(radius * at.x * c, at.y, radius * at.x * s));
    }
    stage.wire(curve(path, 0.02), 0.0018, 0.018, gold);
  }
  for (const dvec2 ring : {dvec2(1.0, -0.13), dvec2(1.0, -wall), dvec2(0.80, -wall - 0.10)}) {
    std::vector<dvec3> path;
    for (int k = 0; k <= 48; ++k)
      path.push_back(frame.at(radius * ring.x * std::cos(2.0 * pi * k / 48), ring.y,
                              radius * ring.x * std::sin(2.0 * pi * k / 48)));
    stage.wire(path, 0.0025, 0.02, gold);
  }
  const dvec3 top = base - dvec3(0, wall + 0.17, 0);
  stage.ellipsoid({top}, dvec3(0.016), 0.009, gold);
  stage.wire({top, {top.x, room_low.y, top.z}}, 0.003, 0.02, {.colour = {0.30, 0.26, 0.20}});
  stage.wire({frame.at(-radius, -0.12, 0), frame.at(radius, -0.12, 0)}, 0.005, 0.02,
             {.colour = {0.50, 0.34, 0.20}});
  add_bird(stage, frame.at(0.02, -0.125, 0));
}

void add_fairy_lights(Stage& stage) {
  const dvec3 from(room_low.x + 0.02, -2.50, -0.55), to(room_high.x - 0.02, -2.45, 1.2);
  const dvec3 colours[] = {
      {1.0, 0.72, 0.36}, {0.95, 0.36, 0.30}, {0.98, 0.86, 0.46}, {0.45, 0.75, 0.55}, {0.45, 0.62, 0.92}};
  constexpr int lights = 17;
  const auto sag = [&](double t) {
    return mix(from, to, t) + dvec3(0, 0.07 * std::sin(3.0 * pi * t) * std::sin(3.0 * pi * t), 0);
  };
  std::vector<dvec3> cable;
  for (int k = 0; k <= 120; ++k) cable.push_back(sag(k / 120.0));
  stage.wire(cable, 0.003, 0.035, {.colour = {0.16, 0.18, 0.14}});
  for (int k = 0; k < lights; ++k) {
    const dvec3 at = sag((k + 0.5) / lights) + dvec3(0, 0.028, 0);
    stage.ellipsoid({at}, {0.016, 0.024, 0.016}, 0.009,
                    Material{.colour = colours[k % 5], .opacity = 0.92, .glow = 2.5});
    const dmat3 axes(1.0);  // a faint halo
    stage.disc(at, axes, dvec3(0.035), {.colour = colours[k % 5], .opacity = 0.10, .lit = false});
  }
}

void add_toys(Stage& stage) {
  stage.group();
  const Frame beach = rolled(turned({-0.62, -0.12, 0.62}, 25.0), 20.0);
  stage.ellipsoid(beach, dvec3(0.12), 0.012, [](double a, double b) {
    const dvec3 colours[] = {{0.90, 0.24, 0.20}, {0.95, 0.93, 0.88}, {0.20, 0.44, 0.76},
                             {0.95, 0.93, 0.88}, {0.96, 0.76, 0.20}, {0.95, 0.93, 0.88}};
    const int slice = std::clamp(static_cast<int>((a + pi) / (2.0 * pi) * 6.0), 0, 5);
    return Material{.colour = std::abs(b) > 1.35 ? dvec3(0.95, 0.93, 0.88) : colours[slice],
                    .gloss = 2.0,
                    .sharpness = 16};
  });
  stage.block(Shape::ellipsoid, beach, dvec3(-0.118), dvec3(0.118));
  // A tower of wooden blocks.
  const dvec3 colours[] = {{0.80, 0.25, 0.22}, {0.22, 0.45, 0.66}, {0.92, 0.72, 0.25}, {0.36, 0.58, 0.34}};
  for (int k = 0; k < 6; ++k) {  // three, two, one
    const int layer = k < 3 ? 0 : k < 5 ? 1 : 2, place = k - (layer == 0 ? 0 : layer == 1 ? 3 : 5);
    const dvec3 foot(-0.66 + 0.11 * place + 0.055 * layer, -0.012 - 0.08 * layer, 0.12 + 0.02 * (k % 2));
    const Frame block = turned(foot, 17.0 * k);
    stage.box(block, {-0.04, -0.08, -0.04}, {0.04, -0.001, 0.04}, Grain(0.013),
              Material{.colour = colours[k % 4], .gloss = 0.8});
    stage.block(Shape::box, block, {-0.04, -0.08, -0.04}, {0.04, 0, 0.04});
  }
}

void add_near_plant(Stage& stage) {
  const Frame pot{{-1.46, -0.95, -1.16}};
  stage.group();
  stage.lathe(pot,
              {{0.0, -0.17}, {0.10, -0.17}, {0.115, -0.18}, {0.115, -0.15}, {0.10, -0.145}, {0.075, 0.0}},
              0.014, [](double, double v) {
                if (v < 0.10) return Material{.colour = {0.24, 0.17, 0.12}};
                return Material{.colour = dvec3(0.76, 0.42, 0.28) * (0.95 + 0.1 * noise(60.0 * v, 1.0)),
                                .gloss = 0.4};
              });
  stage.block(Shape::cylinder, pot, {-0.105, -0.17, -0.105}, {0.105, 0, 0.105});
  // A tall stand of three legs.
  stage.lathe(pot, {{0.0, 0.0}, {0.14, 0.0}, {0.14, 0.02}, {0.0, 0.02}}, 0.02,
              Material{.colour = {0.42, 0.26, 0.16}, .gloss = 1.0});
  stage.block(Shape::cylinder, pot, {-0.14, 0, -0.14}, {0.14, 0.02, 0.14});
  for (int k = 0; k < 3; ++k) {
    const double a = 2.0 * pi * k / 3.0 + 0.5;
    stage.tube(curve({pot.at(0.09 * std::cos(a), 0.02, 0.09 * std::sin(a)),
                      pot.at(0.16 * std::cos(a), 0.95, 0.16 * std::sin(a))},
                     0.05),
               0.013, 0.02, Material{.colour = {0.42, 0.26, 0.16}});
  }
  // Leaves on thin stems; the nearest one reaches the viewer's arm.
  for (int k = 0; k < 22; ++k) {
    const double a = 2.4 * k, rise = 0.12 + 0.30 * hash(k, 91), reach = 0.10 + 0.16 * hash(k, 92);
    const dvec3 outwards(std::cos(a), 0, std::sin(a));
    const dvec3 root = pot.at(0.02 * outwards.x, -0.17, 0.02 * outwards.z);
    const dvec3 joint = pot.at(reach * outwards.x, -0.17 - rise, reach * outwards.z);
    stage.wire(curve({root, mix(root, joint, 0.5) - dvec3(0, 0.05, 0), joint}, 0.02), 0.0025, 0.012,
               {.colour = {0.36, 0.50, 0.22}});
    const dvec3 colour = mix(dvec3(0.16, 0.36, 0.15), dvec3(0.40, 0.56, 0.22), hash(k, 93));
    add_leaf(stage, joint, glm::normalize(outwards + dvec3(0, -0.15, 0)),
             {0.13 + 0.06 * hash(k, 94), 0.055, 0.006, colour});
  }
}

}  // namespace binosplat::demo::room
