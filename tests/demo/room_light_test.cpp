#include "demo/room_light.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace binosplat::demo::room {
namespace {

/// The brightness (green) of Gaussian i seen along `direction`, as a model of degree 3 defines it.
double seen(const Model& model, std::size_t i, const dvec3& direction) {
  const dvec3 d = glm::normalize(direction);
  const double x = d.x, y = d.y, z = d.z;
  const std::array<double, 16> basis = {0.28209479177387814,
                                        -0.4886025119029199 * y,
                                        0.4886025119029199 * z,
                                        -0.4886025119029199 * x,
                                        1.0925484305920792 * x * y,
                                        -1.0925484305920792 * y * z,
                                        0.31539156525252005 * (2 * z * z - x * x - y * y),
                                        -1.0925484305920792 * x * z,
                                        0.5462742152960396 * (x * x - y * y),
                                        -0.5900435899266435 * y * (3 * x * x - y * y),
                                        2.890611442640554 * x * y * z,
                                        -0.4570457994644658 * y * (4 * z * z - x * x - y * y),
                                        0.3731763325901154 * z * (2 * z * z - 3 * x * x - 3 * y * y),
                                        -0.4570457994644658 * x * (4 * z * z - x * x - y * y),
                                        1.445305721320277 * z * (x * x - y * y),
                                        -0.5900435899266435 * x * (x * x - 3 * y * y)};
  double sum = 0.5;
  for (std::size_t k = 0; k < 16; ++k) sum += basis[k] * model.sh[(i * 16 + k) * 3 + 1];
  return sum;
}

/// A lamp by itself in a dark room: 1 m to the right of the middle of the floor and 1 m above it.
Lighting lamp_only() {
  Lighting light{};
  light.room_low = {-3, -3, -3};
  light.room_high = {3, 0, 3};
  light.opening_low = light.opening_high = {0, -1};
  light.to_sun = {0, 0, 1};
  light.lamp_position = {1, -1, 0};
  light.lamp = {1.5, 1.5, 1.5};
  return light;
}

const dmat3 facing_up = axes_from_normal({0, -1, 0}, {1, 0, 0});

/// Whether a glossy disc is brightest where the lamp's mirror image is: for an eye at (-1, -1, 0).
bool mirrors_the_lamp(const Model& model) {
  const double mirrored = seen(model, 0, {1, 1, 0});  // the direction from that eye to the disc
  for (const dvec3& eye : {dvec3(1, -1, 0), dvec3(0, -1, 0), dvec3(0, -1, 1), dvec3(0, -1, -1)}) {
    if (seen(model, 0, -eye) > mirrored - 0.02) return false;
  }
  return true;
}

TEST(BakedLight, GlossMirrorsTheLamp) {
  Stage stage(1);
  stage.disc({0, 0, 0}, facing_up, dvec3(0.01), {.colour = dvec3(0.2), .gloss = 3.0, .sharpness = 14});
  Model model = bake(stage, lamp_only());
  EXPECT_TRUE(mirrors_the_lamp(model));
  // Directions from the Gaussian to the eye instead: the signs of odd degrees turn.
  for (std::size_t k : {1, 2, 3, 9, 10, 11, 12, 13, 14, 15}) {
    for (std::size_t c = 0; c < 3; ++c) model.sh[k * 3 + c] *= -1.0f;
  }
  EXPECT_FALSE(mirrors_the_lamp(model)) << "a turned direction goes unnoticed";
}

TEST(BakedLight, WithoutGlossEveryEyeSeesTheSame) {
  Stage stage(1);
  stage.disc({0, 0, 0}, facing_up, dvec3(0.01), {.colour = dvec3(0.5)});
  const Model model = bake(stage, lamp_only());
  EXPECT_GT(seen(model, 0, {1, 1, 0}), 0.1);
  EXPECT_EQ(seen(model, 0, {1, 1, 0}), seen(model, 0, {-1, 2, 0.5}));
}

TEST(BakedLight, SolidsCastShadows) {
  // Each solid stands half-way to the lamp; a second disc sees past it.
  for (const Solid::Shape shape : {Solid::Shape::box, Solid::Shape::ellipsoid, Solid::Shape::cylinder}) {
    Stage stage(1);
    stage.disc({0, 0, 0}, facing_up, dvec3(0.01), {.colour = dvec3(0.5)});
    stage.disc({0, 0, 1}, facing_up, dvec3(0.01), {.colour = dvec3(0.5)});
    const Model lit = bake(stage, lamp_only());
    stage.block(shape, turned({0.5, -0.5, 0}, 30.0), dvec3(-0.1), dvec3(0.1));
    const Model shaded = bake(stage, lamp_only());
    EXPECT_GT(seen(lit, 0, {0, 1, 0}), 0.1);
    EXPECT_LT(seen(shaded, 0, {0, 1, 0}), 0.01);
    EXPECT_EQ(seen(shaded, 1, {0, 1, 0}), seen(lit, 1, {0, 1, 0}));
  }
}

TEST(BakedLight, OutsideNothingIsLit) {
  Stage stage(1);
  stage.disc({0, 0, 50}, facing_up, dvec3(1), {.colour = {0.2, 0.7, 0.3}});
  EXPECT_NEAR(seen(bake(stage, lamp_only()), 0, {0, 0, 1}), 0.7, 1e-6);
}

}  // namespace
}  // namespace binosplat::demo::room
