// demo:room: furniture, the lamp and the pictures.
#include <algorithm>
#include <cmath>

#include "demo/room_parts.h"

namespace binosplat::demo::room {

namespace {

/// Wood with its grain along u.
Texture wooden(const dvec3& colour, double seed, double gloss = 1.5) {
  return [=](double u, double v) {
    const double grain = fractal(2.0 * u + 13.0 * seed, 45.0 * v + 31.0 * seed);
    return Material{.colour = colour * (0.78 + 0.44 * grain), .gloss = gloss, .sharpness = 12};
  };
}

/// Turned or bent wood: its grain along v, the way along a tube or a profile; u is an angle.
Texture round_wood(const dvec3& colour, double seed) {
  const Texture flat = wooden(colour, seed);
  return [flat](double angle, double way) { return flat(way, 0.02 * std::sin(angle)); };
}

const dvec3 walnut{0.42, 0.26, 0.16}, oak{0.66, 0.47, 0.29}, brass{0.74, 0.56, 0.27};

std::vector<dvec3> straight(const dvec3& from, const dvec3& to, double step) {
  return curve({from, to}, step);
}

}  // namespace

void add_table(Stage& stage) {
  stage.group();
  const Frame frame{{0.95, 0, 0.5}};
  constexpr double radius = 0.55, top = -0.74;
  const auto plate = [=](double angle, double v) {
    // The boards of the top run across it, whatever the ring.
    const double r = std::min(v, radius), x = r * std::cos(angle), z = r * std::sin(angle);
    const double board = std::floor(z / 0.11), grain = fractal(2.5 * x + 7.0 * board, 50.0 * z);
    const double joint = std::abs(std::remainder(z + 0.055, 0.11)) < 0.006 && v < radius ? 0.7 : 1.0;
    return Material{
        .colour = walnut * (0.85 + 0.5 * grain) * joint * (0.92 + 0.16 * hash(static_cast<int>(board), 8)),
        .gloss = 4.0,
        .sharpness = 16};
  };
  stage.lathe(frame, {{0.0, top}, {radius, top}, {radius, top + 0.035}, {0.9 * radius, top + 0.035}}, 0.021,
              plate);
  stage.block(Shape::cylinder, frame, {-radius, top, -radius}, {radius, top + 0.035, radius});
  stage.lathe(frame,
              {{0.05, top + 0.03}, {0.055, -0.6}, {0.08, -0.5}, {0.05, -0.35}, {0.06, -0.12}, {0.10, -0.08}},
              0.02, round_wood(walnut, 3));
  stage.block(Shape::cylinder, frame, {-0.055, top, -0.055}, {0.055, -0.05, 0.055});
  for (int k = 0; k < 3; ++k) {
    const Frame leg = turned(frame.origin, 120.0 * k + 20.0);
    stage.tube(curve({leg.at(0.05, -0.13, 0), leg.at(0.18, -0.11, 0), leg.at(0.32, -0.03, 0),
                      leg.at(0.38, -0.02, 0)},
                     0.02),
               0.022, 0.02, round_wood(walnut, 4 + k));
    stage.block(Shape::box, leg, {0.05, -0.12, -0.02}, {0.36, 0, 0.02});
  }
}

void add_chair(Stage& stage, const Frame& frame) {
  stage.group();
  constexpr double seat = -0.45;
  stage.solid_box(frame, {-0.21, seat, -0.20}, {0.21, seat + 0.03, 0.20}, {0.05, 0.025}, wooden(oak, 11));
  stage.ellipsoid(
      {frame.at(0, seat - 0.012, 0), frame.axes}, {0.19, 0.03, 0.18}, 0.018, [](double a, double) {
        return Material{.colour = std::abs(std::remainder(a, pi / 6.0)) < 0.08 ? dvec3(0.90, 0.86, 0.76)
                                                                               : dvec3(0.28, 0.42, 0.52)};
      });
  for (const double x : {-1.0, 1.0}) {
    for (const double z : {-1.0, 1.0}) {
      stage.tube(straight(frame.at(0.17 * x, seat + 0.03, 0.16 * z), frame.at(0.21 * x, 0, 0.20 * z), 0.04),
                 0.016, 0.02, round_wood(oak, 12));
      stage.block(Shape::box, frame, {0.19 * x - 0.015, seat, 0.18 * z - 0.015},
                  {0.19 * x + 0.015, 0, 0.18 * z + 0.015});
    }
  }
  // A back of thin spindles under a bent rail; the sitter looks to low z.
  for (int k = 0; k < 7; ++k) {
    const double x = -0.17 + 0.34 * k / 6.0, bend = 0.04 * (1.0 - x * x / 0.04);
    stage.wire({frame.at(x, seat, 0.17), frame.at(1.08 * x, -0.88, 0.25 + bend)}, 0.007, 0.03,
               {.colour = oak, .gloss = 0.6});
  }
  stage.tube(curve({frame.at(-0.21, -0.86, 0.22), frame.at(-0.12, -0.89, 0.265), frame.at(0, -0.90, 0.285),
                    frame.at(0.12, -0.89, 0.265), frame.at(0.21, -0.86, 0.22)},
                   0.025),
             0.020, 0.016, round_wood(oak, 14));
  stage.block(Shape::box, frame, {-0.21, -0.91, 0.24}, {0.21, -0.86, 0.28});
}

void add_armchair(Stage& stage) {
  stage.group();
  const Frame frame = turned({-1.72, 0, 0.95}, 35.0);  // the sitter looks to low z
  const auto cloth = [](double u, double v) {
    const double weave = noise(90.0 * u, 90.0 * v);
    return Material{.colour = dvec3(0.80, 0.56, 0.18) * (0.90 + 0.2 * weave)};
  };
  const auto block = [&](const dvec3& low, const dvec3& high) {
    stage.solid_box(frame, low, high, Grain(0.036), cloth);
  };
  const auto roll = [&](const dvec3& from, const dvec3& to,
                        double radius) {  // a rounded edge with its two ends
    stage.tube(straight(from, to, 0.03), radius, 0.028, cloth);
    const dvec3 along = glm::normalize(to - from);
    for (const bool end : {false, true}) {
      const dvec3 normal = end ? along : -along;
      for (int k = 0; k < 19; ++k) {
        const double r = radius * (k == 0  ? 0.0
                                   : k < 7 ? 0.42
                                           : 0.80),
                     angle = k * (k < 7 ? pi / 3.0 : pi / 6.0);
        const dmat3 axes = axes_from_normal(normal, {0, 1, 0});
        const dvec3 p = (end ? to : from) + r * (std::cos(angle) * axes[0] + std::sin(angle) * axes[1]);
        stage.disc(p, axes, {0.26 * radius, 0.26 * radius, 0.002}, cloth(angle, r));
      }
    }
  };
  block({-0.32, -0.36, -0.36}, {0.32, -0.10, 0.30});
  stage.ellipsoid({frame.at(0, -0.38, -0.04), frame.axes}, {0.31, 0.09, 0.33}, 0.028, cloth);
  block({-0.42, -0.52, -0.38}, {-0.30, -0.08, 0.34});
  block({0.30, -0.52, -0.38}, {0.42, -0.08, 0.34});
  roll(frame.at(-0.37, -0.54, -0.39), frame.at(-0.37, -0.54, 0.34), 0.085);
  roll(frame.at(0.37, -0.54, -0.39), frame.at(0.37, -0.54, 0.34), 0.085);
  block({-0.40, -0.88, 0.26}, {0.40, -0.08, 0.40});
  roll(frame.at(-0.41, -0.90, 0.33), frame.at(0.41, -0.90, 0.33), 0.08);
  for (const double x : {-0.36, 0.36}) {
    for (const double z : {-0.32, 0.34}) {
      stage.tube(straight(frame.at(x, -0.10, z), frame.at(x, 0, z), 0.03), 0.022, 0.02,
                 round_wood(walnut, 21));
    }
  }
  const Frame cushion = rolled({frame.at(0.08, -0.58, 0.16), frame.axes}, 14.0);
  stage.ellipsoid(cushion, {0.20, 0.19, 0.08}, 0.018, [](double a, double b) {
    const bool stripe = std::fmod(std::cos(a) * std::cos(b) + 2.0, 0.4) < 0.2;
    return Material{.colour = stripe ? dvec3(0.20, 0.40, 0.44) : dvec3(0.90, 0.86, 0.76)};
  });
}

namespace {

// The bookshelf: its front and back, and its sides within.
constexpr double shelf_front = 2.18, shelf_back = 2.48, shelf_begin = 0.55, shelf_end = 1.75;

/// A row of books on a shelf, whose spines look to low x; `room` is the height that there is for them.
void add_books(Stage& stage, int shelf, double y, double room) {
  double z = shelf_begin + 0.01;
  for (int book = 0; z < shelf_end - 0.08; ++book) {
    const double thick = 0.022 + 0.032 * hash(shelf, book),
                 tall = room * (0.62 + 0.28 * hash(book, shelf + 50));
    if (hash(shelf + 9, book) < 0.10) {  // a gap
      z += 0.08;
      continue;
    }
    const double x = shelf_front + 0.03 + 0.03 * hash(book, shelf + 70),
                 hue = 2.0 * pi * hash(shelf + 20, book);
    const dvec3 dye(0.46 + 0.20 * std::cos(hue), 0.38 + 0.12 * std::cos(hue + 2.3),
                    0.33 + 0.12 * std::cos(hue + 4.4));
    const dvec3 cover = dye * (0.65 + 0.65 * hash(book, shelf + 33));
    const double label = 0.15 + 0.5 * hash(book + 3, shelf);
    stage.sheet({x, y, z}, {0, -tall, 0}, {0, 0, thick}, {0.024, 0.020}, [&](double u, double) {
      const bool band = std::abs(u / tall - label) < 0.07 || std::abs(u / tall - 0.9) < 0.03;
      return Material{.colour = band ? mix(cover, {0.92, 0.82, 0.55}, 0.7) : cover, .gloss = 0.5};
    });
    stage.sheet({x, y - tall, z}, {0.18, 0, 0}, {0, 0, thick}, {0.05, 0.025},
                Material{.colour = {0.88, 0.84, 0.74}});
    stage.sheet({x, y, z}, {0.10, 0, 0}, {0, -tall, 0}, {0.05, 0.05}, Material{.colour = cover});
    z += thick + 0.003;
  }
}

void add_globe(Stage& stage, const dvec3& foot) {
  const Frame globe{foot - dvec3(0, 0.19, 0)};
  stage.ellipsoid(globe, dvec3(0.13), 0.013, [](double a, double b) {
    const double land =
        fractal(1.6 * std::cos(a) * std::cos(b) + 5.0, 2.6 * b + 1.6 * std::sin(a) * std::cos(b));
    return Material{.colour = land > 0.52 ? dvec3(0.72, 0.66, 0.38) : dvec3(0.26, 0.46, 0.60), .gloss = 2.0};
  });
  stage.block(Shape::ellipsoid, globe, dvec3(-0.13), dvec3(0.13));
  stage.lathe({foot}, {{0.012, -0.07}, {0.015, -0.03}, {0.075, -0.015}, {0.08, 0.0}}, 0.013,
              Material{.colour = brass, .gloss = 3.0});
}

}  // namespace

void add_bookshelf(Stage& stage) {
  stage.group();
  constexpr double x0 = shelf_front, x1 = shelf_back, z0 = shelf_begin, z1 = shelf_end;
  constexpr double top = -2.05, board = 0.025;
  const Frame world;
  const auto plank = wooden({0.46, 0.30, 0.19}, 31);
  const auto part = [&](const dvec3& low, const dvec3& high) {
    stage.solid_box(world, low, high, {0.07, 0.03}, plank);
  };
  part({x0, top, z0 - board}, {x1, 0, z0});
  part({x0, top, z1}, {x1, 0, z1 + board});
  stage.sheet({x1 - 0.01, 0, z0}, {0, top, 0}, {0, 0, z1 - z0}, {0.08, 0.04, Border::overlaps}, plank);
  stage.block(Shape::box, world, {x1 - 0.005, top, z0 - board}, {x1 + 0.04, 0, z1 + board});
  constexpr int shelves = 5;
  for (int shelf = 0; shelf <= shelves; ++shelf) {
    const double y = -0.06 + (top + 0.06) * shelf / shelves;
    part({x0, y, z0}, {x1, y + board, z1});
    if (shelf == shelves) break;
    const double room = -(top + 0.06) / shelves - board;
    add_books(stage, shelf, y, room);
    // The books as one: what is behind their spines is not seen, and casts the same shadow.
    stage.block(Shape::box, world, {x0 + 0.06, y - 0.7 * room, z0}, {x1 - 0.02, y, z1});
  }
  add_globe(stage, {2.31, top, 1.45});
}

void add_lamp(Stage& stage) {
  const dvec3 bulb = lamp_bulb;
  stage.wire({{bulb.x, room_low.y, bulb.z}, bulb - dvec3(0, 0.22, 0)}, 0.004, 0.02,
             {.colour = {0.12, 0.11, 0.10}});
  stage.lathe({{bulb.x, room_low.y, bulb.z}}, {{0.01, 0.05}, {0.06, 0.03}, {0.06, 0.0}}, 0.015,
              Material{.colour = brass, .gloss = 3.0});
  // The shade glows from within.
  stage.lathe(
      {bulb}, {{0.05, -0.20}, {0.09, -0.17}, {0.19, -0.04}, {0.25, 0.08}}, 0.017, [](double angle, double) {
        const double rib = 0.9 + 0.1 * std::cos(16.0 * angle);
        return Material{
            .colour = dvec3(0.96, 0.80, 0.52) * rib, .opacity = 0.93, .glow = 0.16, .two_sided = true};
      });
  stage.lathe({bulb}, {{0.02, -0.23}, {0.035, -0.22}, {0.05, -0.195}}, 0.012,
              Material{.colour = brass, .gloss = 3.0});
  stage.ellipsoid({bulb}, {0.045, 0.055, 0.045}, 0.012, Material{.colour = {1.0, 0.95, 0.82}, .glow = 6.0});
}

namespace {

/// What is painted: x and y from 0 to 1, y upwards.
dvec3 evening_by_the_sea(double x, double y) {
  if (y < 0.34) {
    const double glitter = 0.7 * std::exp(-6.0 * std::abs(x - 0.62)) + 0.25 * noise(9.0 * x, 50.0 * y);
    return mix({0.16, 0.26, 0.40}, {0.86, 0.58, 0.36}, glitter);
  }
  const double from_sun = (x - 0.62) * (x - 0.62) * 2.2 + (y - 0.45) * (y - 0.45);
  if (from_sun < 0.012) return {1.0, 0.90, 0.62};
  return mix({0.95, 0.62, 0.36}, {0.30, 0.36, 0.56}, ramp(0.34, 1.0, y + 0.15 * fractal(3.0 * x, 7.0 * y)));
}

dvec3 two_circles(double x, double y) {
  if (std::hypot(x - 0.4, y - 0.6) < 0.2) return {0.82, 0.34, 0.24};
  if (std::hypot(x - 0.62, y - 0.38) < 0.26) return {0.20, 0.36, 0.46};
  return {0.92, 0.87, 0.76};
}

dvec3 fern(double x, double y) {
  const double stem = std::abs(x - 0.5 - 0.05 * std::sin(6.0 * y));
  const bool leaf =
      std::abs(std::remainder(y - 0.9 * stem, 0.11)) < 0.03 && stem < 0.32 * (1.0 - y) + 0.02 && y > 0.12;
  return leaf || (stem < 0.012 && y < 0.9) ? dvec3(0.22, 0.38, 0.24) : dvec3(0.93, 0.91, 0.84);
}

struct Picture {
  dvec3 corner;          // the lower left one, on the wall
  dvec3 edge_u, edge_v;  // to the right and upwards
  double grain;
  dvec3 frame_colour;
  dvec3 (*motif)(double x, double y);
};

/// Hangs a picture behind glass.
void hang(Stage& stage, const Picture& picture) {
  const dvec3 &corner = picture.corner, &edge_u = picture.edge_u, &edge_v = picture.edge_v;
  const double w = glm::length(edge_u), h = glm::length(edge_v);
  const dvec3 u = edge_u / w, v = edge_v / h, out = glm::cross(u, v);
  stage.sheet(corner + 0.012 * out, edge_u, edge_v, Grain(picture.grain), [&](double a, double b) {
    constexpr double margin = 0.045;
    const double x = (a - margin) / (w - 2.0 * margin), y = (b - margin) / (h - 2.0 * margin);
    const bool painted = x > 0.0 && x < 1.0 && y > 0.0 && y < 1.0;
    return Material{
        .colour = painted ? picture.motif(x, y) : dvec3(0.94, 0.92, 0.87), .gloss = 2.0, .sharpness = 14};
  });
  const Frame frame{corner + edge_v, dmat3(u, -v, -out)};  // x to the right, y down, z into the wall
  constexpr double bar = 0.03, front = -0.03;
  const auto rail = [&](const dvec3& low, const dvec3& high) {
    stage.box(frame, low, high, {0.035, 0.015}, wooden(picture.frame_colour, 41));
  };
  rail({-bar, -bar, front}, {w + bar, 0, 0});
  rail({-bar, h, front}, {w + bar, h + bar, 0});
  rail({-bar, 0, front}, {0, h, 0});
  rail({w, 0, front}, {w + bar, h, 0});
  stage.block(Shape::box, frame, {-bar, -bar, -0.008}, {w + bar, h + bar, 0.04});
}

}  // namespace

void add_pictures(Stage& stage) {
  const double back = room_high.z, left = room_low.x;
  stage.group();
  hang(stage, {{0.95, -1.28, back}, {0.42, 0, 0}, {0, -0.56, 0}, 0.015, walnut, fern});
  hang(stage, {{1.52, -1.36, back}, {0.42, 0, 0}, {0, -0.42, 0}, 0.016, brass, two_circles});
  stage.group();
  hang(stage, {{left, -1.12, -0.75}, {0, 0, 1.3}, {0, -0.85, 0}, 0.025, walnut, evening_by_the_sea});
}

}  // namespace binosplat::demo::room
