#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "demo/city_parts.h"
#include "demo/demo.h"
#include "demo/light.h"

namespace binosplat {

namespace {

using namespace demo;

// The plan, in metres. Streets lie along z, the main street at x = 0, and narrower side streets along x.
constexpr int streets_beside = 5;  // on either side of the main street
constexpr int blocks_along = 12;
constexpr double street_pitch = 64.0, crossing_pitch = 100.0, first_crossing = -120.0;
constexpr double last_crossing = first_crossing + blocks_along * crossing_pitch;
constexpr double road = 4.5, front = 7.5;  // from the middle of a street to the kerb and to the houses
constexpr double side_road = 3.5, side_front = 6.0;  // the same for a side street
constexpr double kerb = 0.12;                        // height of pavements

Material asphalt(double x, double z) {
  const double patches = fractal(0.35 * x + 31.0, 0.22 * z), grit = noise(19.0 * x, 19.0 * z);
  return {.colour = dvec3(0.345, 0.35, 0.365) * (0.82 + 0.24 * patches + 0.12 * grit), .gloss = 0.16};
}

/// Returns the material of a street along z, with crossings; x is measured from its middle.
Material road_at(double x, double z) {
  const double along = part_of(z - first_crossing, crossing_pitch);
  const double from_crossing = std::min(along, crossing_pitch - along);
  const bool zebra = from_crossing > 5.0 && from_crossing < 8.2 && part_of(x + 0.25, 1.0) < 0.5;
  const bool middle = std::abs(x) < 0.07 && part_of(z, 5.0) < 2.2;
  const bool parking = std::abs(std::abs(x) - 2.45) < 0.05 && part_of(z, 5.4) < 4.9;
  if (zebra || (from_crossing > 9.0 && (middle || parking)))
    return {.colour = dvec3(0.90, 0.90, 0.87) * (0.82 + 0.12 * noise(6.0 * x, 6.0 * z)), .gloss = 0.1};
  Material look = asphalt(x, z);
  look.colour *= 0.84 + 0.16 * ramp(0.0, 0.4, road - std::abs(x));  // dirt in the gutter
  return look;
}

/// Returns the material of a block's pavements, kerbs and yard, `u` m along it and `v` m from its side.
Material block_at(double u, double v) {
  constexpr double wide = street_pitch - 2.0 * road, tall = crossing_pitch - 2.0 * side_road;
  if (std::min(v, wide - v) > front - road && std::min(u, tall - u) > side_front - side_road) {
    const double tufts = fractal(0.4 * u + 3.0, 0.4 * v + 8.0), blades = noise(9.0 * u, 9.0 * v);
    return {.colour = mix({0.27, 0.38, 0.15}, {0.47, 0.52, 0.24}, tufts) * (0.88 + 0.24 * blades)};
  }
  const bool joint = std::min(part_of(v, 0.5), part_of(u, 0.75)) < 0.025;
  const double shade = 0.92 + 0.1 * hash_at(v / 0.5, u / 0.75) + 0.08 * fractal(0.8 * u, 0.8 * v);
  return {.colour = dvec3(0.66, 0.645, 0.615) * (joint ? 0.78 * shade : shade), .gloss = 0.06};
}

Material fields_at(double x, double z) {
  return {.colour = mix({0.33, 0.45, 0.19}, {0.60, 0.58, 0.32},
                        hash_at(x / 90.0 + noise(z / 240.0, x / 240.0), z / 70.0))};
}

void add_street_tree(SceneBuilder& stage, Random& random, const dvec3& foot, double largest) {
  static const dvec3 leaves[] = {{0.36, 0.44, 0.18}, {0.29, 0.40, 0.18}, {0.44, 0.47, 0.20}};
  const double radius = random.uniform(1.7, largest);
  stage.frame = {};
  add_tree(stage, foot, radius, pick(random, leaves));
}

void add_lamp_post(SceneBuilder& stage, const LocalAxes& frame) {  // x points over the street
  stage.frame = frame;
  const double grain = stage.grain({});
  if (grain > 0.6) return;
  const Material iron{.colour = {0.20, 0.23, 0.23}, .gloss = 0.2};
  stage.wire({{0, 0, 0}, {0, -4.6, 0}}, 0.05, grain, iron);
  stage.wire({{0, -4.55, 0}, {0.8, -4.75, 0}}, 0.03, grain, iron);
  const Material lantern{.colour = {0.96, 0.92, 0.80}, .gloss = 0.3, .glow = 0.2};
  stage.box({0.62, -4.70, -0.16}, {0.94, -4.25, 0.16}, {}, lantern);
}

// Side view of a car: position along its length (z, forwards) and height (y, downwards).
constexpr std::array outline = {dvec2(2.08, -0.28),  dvec2(2.12, -0.62),  dvec2(1.96, -0.80),
                                dvec2(0.98, -0.92),  dvec2(0.28, -1.40),  dvec2(-0.95, -1.43),
                                dvec2(-1.68, -0.97), dvec2(-2.06, -0.86), dvec2(-2.10, -0.28)};
constexpr double car_half = 0.85;

/// Returns the material at a point of the car's frame.
Material car_at(const dvec3& paint, const dvec3& p) {
  const double across = std::abs(p.x), along = std::abs(p.z);
  const double wheel = glm::length(dvec2(along - 1.32, p.y + 0.31));
  if (across > car_half - 0.02 && (wheel < 0.37 || p.y > -0.2))
    return {.colour = dvec3(wheel < 0.17 ? 0.62 : wheel < 0.31 ? 0.13 : 0.07), .gloss = 0.2};
  const bool pillar = across > car_half - 0.13 && std::abs(p.z + 0.30) < 0.05;
  if (p.y < -0.98 && p.y > -1.37 && !pillar) return {.colour = {0.26, 0.30, 0.34}, .gloss = 0.9};
  if (along > 1.98 && p.y > -0.78 && p.y < -0.56 && across > 0.5)
    return {.colour = p.z > 0.0 ? dvec3(0.93, 0.94, 0.92) : dvec3(0.72, 0.07, 0.06), .gloss = 0.5};
  if (along > 2.0 && p.y > -0.52 && p.y < -0.40 && across < 0.27) return {.colour = {0.88, 0.88, 0.82}};
  return {.colour = paint * (p.y > -0.34 ? 0.35 : 1.0), .gloss = 0.45};
}

void add_car(SceneBuilder& stage, const LocalAxes& frame, const dvec3& paint) {  // z points forwards
  stage.frame = frame;
  stage.solid(Solid::Shape::box, {-car_half, -1.1, -2.0}, {car_half, 0.0, 2.0});
  if (stage.grain({}) > 0.7) return;
  const auto panel = [&](const dvec3& corner, const dvec3& u, const dvec3& v) {
    const auto look = [=, a = glm::normalize(u), b = glm::normalize(v)](double along, double across) {
      return car_at(paint, corner + along * a + across * b);
    };
    stage.sheet(corner, u, v, look, Grain(0.8), border_left | border_right);
  };
  for (std::size_t k = 0; k + 1 < outline.size(); ++k) {
    const dvec2 a = outline[k], b = outline[k + 1];
    panel({car_half, a.y, a.x}, -2.0 * car_half * right, {0.0, b.y - a.y, b.x - a.x});
  }
  for (const double side : {-1.0, 1.0}) {
    const auto flank = [&](double x, double behind, double ahead, double low, double tall) {
      panel({side * x, low, side > 0.0 ? behind : ahead}, side * (ahead - behind) * away, tall * up);
    };
    // The body, the wheels that extend below it, and the cabin, which narrows towards the roof.
    flank(car_half, -2.10, 2.10, -0.28, 0.56);
    flank(car_half, -1.68, 1.68, -0.02, 0.26);
    for (int k = 0; k < 4; ++k) {
      const double t = (k + 0.5) / 4.0;
      flank(car_half - 0.10 * t, -1.68 + 0.73 * t, 0.98 - 0.68 * t, -0.84 - 0.1425 * k, 0.1425);
    }
  }
}

void add_street_side(SceneBuilder& stage, Random& random, double x, double crossing, double side) {
  static const dvec3 paints[] = {{0.74, 0.12, 0.11}, {0.66, 0.67, 0.67}, {0.20, 0.22, 0.24},
                                 {0.20, 0.34, 0.56}, {0.56, 0.58, 0.60}, {0.20, 0.38, 0.33},
                                 {0.80, 0.73, 0.57}};
  const double z0 = crossing + side_front, z1 = crossing + crossing_pitch - side_front;
  if (std::abs(x + side * front) < streets_beside * street_pitch)
    add_row(stage, random, {x + side * front, -kerb, side > 0.0 ? z1 : z0}, -side * away, z1 - z0);
  for (double z = z0 + 3.0; z < z1 - 5.0; z += random.uniform(10.0, 15.0)) {
    if (random.uniform() > 0.25) add_street_tree(stage, random, {x + side * 5.6, -kerb, z}, 2.4);
  }
  for (double z = z0 + (side < 0.0 ? 6.0 : 18.0); z < z1; z += 25.0)
    add_lamp_post(stage, {{x + side * 5.0, -kerb, z}, dmat3(-side * right, down, -side * away)});
  for (double z = z0 + 8.5; z < z1 - 8.0; z += 5.4) {
    if (random.uniform() < 0.45) continue;
    const dvec3 place(x + side * 3.45, 0.0, z + random.uniform(-0.3, 0.3));
    add_car(stage, {place, dmat3(side * right, down, side * away)}, pick(random, paints));
  }
}

/// Adds a distant high house.
void add_tower(SceneBuilder& stage, Random& random, double x, double z, double height) {
  const double half = random.uniform(8.0, 18.0);
  const dvec3 wall = mix({0.74, 0.69, 0.62}, {0.52, 0.55, 0.60}, random.uniform());
  stage.frame = {{x, 0.0, z}};
  for (const double share : {1.0, 0.6}) {  // a narrower box on a wider one
    const dvec3 high(half * (1.3 - 0.5 * share), 0.0, half * (1.3 - 0.5 * share));
    stage.box(-high + (1.6 - share) * height * up, high, 0.8, [=](double u, double v) {
      const bool window = std::max(part_of(u / 3.4, 1.0), part_of(v / 3.4, 1.0)) < 0.66;
      return window ? Material{.colour = {0.38, 0.44, 0.50}, .gloss = 0.5} : Material{wall};
    });
  }
}

void add_city(SceneBuilder& stage, std::uint64_t seed) {
  Random random(seed + 6);
  constexpr double start = first_crossing - side_road, end = last_crossing + side_road, around = 2700.0;
  constexpr double edge = streets_beside * street_pitch + road;
  const auto ground = [&](const Texture& look, const dvec2& low, const dvec2& high, double zero,
                          double coarseness) {
    stage.frame = {};
    const dvec2 size = high - low;
    stage.sheet({{low.x, 0, low.y},
                 size.x * right,
                 size.y * away,
                 look,
                 Grain(coarseness),
                 0,
                 {low.x - zero, low.y}});
  };
  for (int i = -streets_beside; i <= streets_beside; ++i) {
    const double x = street_pitch * i, next = x + street_pitch - road;
    ground(road_at, {x - road, start}, {x + road, end}, x, 1.0);
    for (int j = 0; j <= blocks_along; ++j) {
      const double z = first_crossing + crossing_pitch * j;
      if (i < streets_beside) ground(asphalt, {x + road, z - side_road}, {next, z + side_road}, 0.0, 1.0);
      if (j == blocks_along) continue;
      for (const double side : {-1.0, 1.0}) add_street_side(stage, random, x, z, side);
      if (i == streets_beside) continue;
      stage.frame = {};
      stage.box({x + road, -kerb, z + side_road}, {next, 0.0, z + crossing_pitch - side_road}, Grain(),
                block_at);
      for (int k = 0; k < 7; ++k) {  // trees in the yard
        const double along = random.uniform(10.0, crossing_pitch - 10.0);
        add_street_tree(stage, random, {x + random.uniform(22.0, street_pitch - 22.0), -kerb, z + along},
                        3.4);
      }
    }
  }
  // The background: fields around the city; high houses beside the streets and at the main street's ends.
  ground(fields_at, {-around, start}, {-edge, end}, 0.0, 5.0);
  ground(fields_at, {edge, start}, {around, end}, 0.0, 5.0);
  ground(fields_at, {-around, -around}, {around, start}, 0.0, 5.0);
  ground(fields_at, {-around, end}, {around, around}, 0.0, 5.0);
  add_tower(stage, random, 0.0, last_crossing + 45.0, 90.0);
  for (int k = 0; k < 60; ++k) {
    const double far = random.uniform(40.0, 900.0) * (k % 2 == 0 ? 1.0 : -1.0);
    const double z = k < 34 ? random.uniform(1220.0, 1750.0) : random.uniform(100.0, 1300.0);
    const double height = random.uniform(25.0, k < 34 ? 120.0 : 60.0);
    add_tower(stage, random, k < 34 ? far : far + (far > 0.0 ? 380.0 : -380.0), z, height);
  }
  stage.frame = {};
}

/// The grain doubles at this distance from the nearest camera.
constexpr double near_distance = 4.0;
constexpr double along_streets = 0.33;  // weight of distances along a street, where people walk
/// Coarseness raises the grain to at most this share of the distance to the nearest camera. Larger Gaussians
/// would surround the camera like fog.
constexpr double coarsest = 0.1;

Lighting afternoon() {
  return {.to_sun = glm::normalize(dvec3(0.58, -0.66, -0.34)),
          .sun = {1.2, 1.06, 0.85},
          .sky = {0.38, 0.45, 0.57},
          .bounce = {0.19, 0.17, 0.14}};
}

SceneBuilder stage_of(std::uint64_t seed, double finest) {
  SceneBuilder stage([finest, cameras = city_cameras()](const dvec3& p, double coarseness) {
    double near = 1e9;
    for (const Camera& head : cameras)
      near = std::min(near, glm::length((p - head.position) * dvec3(1.0, 1.0, along_streets)));
    const double grain = finest * (1.0 + near / near_distance);
    return std::min(coarseness * grain, std::max(grain, coarsest * near));
  });
  add_city(stage, seed);
  const auto whole = [](const dvec3&) { return true; };
  add_sky(stage, {3100.0, 5.0, afternoon().to_sun, static_cast<double>(seed % 1000), whole});
  return stage;
}

/// Returns the stage whose grain requests about settings.count Gaussians.
SceneBuilder stage_for(const CitySettings& settings) {
  double grain = 0.0517 * std::sqrt(1e6 / static_cast<double>(settings.count));
  for (int round = 1;; ++round) {
    SceneBuilder stage = stage_of(settings.seed, grain);
    double wanted = static_cast<double>(stage.discs.size());
    for (const Surface& s : stage.surfaces) wanted += std::max(1.0, s.weight);
    const double share = wanted / static_cast<double>(settings.count);
    // adjust_count() makes the count exact; a difference of 5 % changes no detail.
    if ((share > 0.95 && share < 1.05) || round == 8) return stage;
    grain *= std::sqrt(share);
  }
}

/// Gives every surface one Gaussian, and shares the rest by weight, so that the total is `count`.
void adjust_count(SceneBuilder& stage, std::size_t count) {
  double sum = 0.0, reached = 0.0;
  for (const Surface& s : stage.surfaces) sum += std::max(0.0, s.weight - 1.0);
  const std::size_t rest = count - stage.discs.size() - stage.surfaces.size();
  std::size_t given = 0;
  for (Surface& s : stage.surfaces) {
    reached += std::max(0.0, s.weight - 1.0);
    const bool last = &s == &stage.surfaces.back();
    const double share = reached / sum * static_cast<double>(rest);
    const std::size_t due = last ? rest : std::min(rest, static_cast<std::size_t>(share));
    s.count = static_cast<std::uint32_t>(1 + due - given);
    given = due;
  }
}

}  // namespace

void check(const CitySettings& settings) {
  if (settings.count >= city_count_min && settings.count <= city_count_max) return;
  fail("`count` {}: {} is made of {} to {} Gaussians", settings.count, demo_city_name, city_count_min,
       city_count_max);
}

std::vector<Camera> city_cameras() {
  return {head_of("street", {-1.2, -1.6, -12.0}, {0.6, -2.6, 60.0}, 60.0),
          head_of("air", {2.5, -25.0, -40.0}, {0.0, -6.0, 60.0}, 60.0),
          head_of("corner", {-5.8, -1.72, 73.4}, {8.0, -2.2, 96.0}, 65.0)};
}

Demo demo_city(const CitySettings& settings) {
  check(settings);
  SceneBuilder stage = stage_for(settings);
  adjust_count(stage, settings.count);
  return {bake(stage, afternoon(), 1, demo_city_name), city_cameras()};
}

}  // namespace binosplat
