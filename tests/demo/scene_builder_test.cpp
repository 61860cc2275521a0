// The shapes of the built-in scenes, and their lighting.

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "demo/light.h"
#include "scene/harmonics.h"

namespace binosplat::demo {
namespace {

const Texture grey = Material{.colour = dvec3(0.5)};

/// Returns all Gaussians of a stage.
std::vector<Disc> discs_of(const SceneBuilder& stage) {
  std::vector<Disc> discs = stage.discs;
  for (const Surface& surface : stage.surfaces)
    make_discs(surface, [&](const Disc& disc) { discs.push_back(disc); });
  return discs;
}

/// Returns whether all axes are orthonormal and right-handed, and all normals point away from `centre`.
bool faces_outwards(const std::vector<Disc>& discs, const dvec3& centre) {
  for (const Disc& disc : discs) {
    const dmat3 square = glm::transpose(disc.axes) * disc.axes;
    for (int k = 0; k < 9; ++k) {
      if (std::abs(square[k / 3][k % 3] - (k % 4 == 0 ? 1.0 : 0.0)) > 1e-9) return false;
    }
    if (glm::determinant(disc.axes) < 0.0 || glm::dot(disc.axes[2], disc.position - centre) <= 0.0)
      return false;
  }
  return !discs.empty();
}

TEST(Random, MatchesSplitMix64) {
  Random random(1234567);  // published numbers of SplitMix64 for this seed
  EXPECT_EQ(random.bits(), 6457827717110365317ull);
  EXPECT_EQ(random.bits(), 3203168211198807973ull);
  for (int i = 0; i < 1000; ++i) {
    const double v = random.uniform(-2.0, 3.0);
    ASSERT_TRUE(v >= -2.0 && v < 3.0);
  }
}

TEST(Noise, IsSmoothAndBounded) {
  for (int i = -50; i < 50; ++i) {
    const double x = 0.37 * i, y = 11.3 - 0.21 * i;
    ASSERT_TRUE(noise(x, y) >= 0.0 && noise(x, y) <= 1.0);
    ASSERT_TRUE(fractal(x, y) >= 0.0 && fractal(x, y) <= 1.0);
    ASSERT_NEAR(noise(x, y), noise(x + 1e-4, y), 5e-4);
    ASSERT_NEAR(circle(x).x, std::cos(2.0 * pi * x), 1e-9);
    ASSERT_NEAR(circle(x).y, std::sin(2.0 * pi * x), 1e-9);
  }
}

TEST(SceneBuilder, SurfacesFaceOutwards) {
  SceneBuilder box, ball, can;
  box.frame = ball.frame = can.frame = turned({1, 2, 3}, 40.0, 25.0);
  const dvec3 centre = box.frame.origin;
  box.box(dvec3(-0.3, -0.2, -0.1), dvec3(0.3, 0.2, 0.1), 0.05, grey);
  EXPECT_TRUE(faces_outwards(discs_of(box), centre));
  ball.ellipsoid({}, {0.3, 0.2, 0.1}, 0.03, grey);
  EXPECT_TRUE(faces_outwards(discs_of(ball), centre));
  can.lathe({}, {{0.0, -0.3}, {0.2, -0.3}, {0.2, 0.3}, {0.0, 0.3}}, 0.04, grey);
  EXPECT_TRUE(faces_outwards(discs_of(can), centre));
  can.discs[5].axes[2] *= -1.0;
  EXPECT_FALSE(faces_outwards(discs_of(can), centre)) << "a disc turned over goes unnoticed";
}

TEST(SceneBuilder, SheetsStayWithinBorder) {
  SceneBuilder stage;
  const auto look = [](double u, double v) {
    EXPECT_TRUE(u > 0.0 && u < 1.0 && v > 0.0 && v < 0.5);
    return Material{};
  };
  stage.sheet({0, 0, 0}, {1, 0, 0}, {0, 0.5, 0}, look, {0.1, 0.05}, all_borders);
  const std::vector<Disc> discs = discs_of(stage);
  EXPECT_GT(discs.size(), 50u);
  for (const Disc& disc : discs) {
    EXPECT_GE(disc.position.x - disc.scale.x, -1e-9);
    EXPECT_LE(disc.position.x + disc.scale.x, 1.0 + 1e-9);
    EXPECT_EQ(disc.axes[2], dvec3(0, 0, 1));
  }
}

TEST(SceneBuilder, WiresAreLongAndThin) {
  SceneBuilder stage;
  stage.wire({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, 0.002, 0.02, {});
  EXPECT_NEAR(static_cast<double>(stage.discs.size()), 100.0, 15.0);
  for (const Disc& disc : stage.discs) EXPECT_GT(disc.scale.x, 8.0 * disc.scale.y);
}

TEST(Solids, HidePointsInside) {
  Solids solids;
  const LocalAxes frame = turned({1, 0, 0}, 30.0);
  solids.add(Solid::Shape::box, frame, dvec3(-0.1), dvec3(0.1));
  EXPECT_TRUE(solids.hide(frame.at({0, 0, 0.09})));
  EXPECT_FALSE(solids.hide(frame.at({0, 0, 0.1}))) << "on a face";
  EXPECT_FALSE(solids.hide(frame.at({0, 0.2, 0}))) << "beside it";
}

/// Returns the brightness (green) of Gaussian i along a viewing direction.
double seen(const Model& model, std::size_t i, const dvec3& direction) {
  return 0.5 + sh_sum({&model.sh[48 * i], 48}, sh_basis(glm::normalize(direction))).g;
}

/// Returns the stage in a dark room with one lamp, 1 m to the right of the floor's middle and 1 m above it.
Model lit_by_lamp(SceneBuilder stage) {
  Lighting light{.to_sun = {0, 0, 1}};
  light.room = {.low = {-3, -3, -3}, .high = {3, 0, 3}, .lamps = {{{1, -1, 0}, dvec3(1.5)}}};
  return bake(stage, light, 3, "test");
}

const dmat3 facing_up = axes_from_normal({0, -1, 0}, {1, 0, 0});

/// Returns whether a glossy disc is brightest for the eye that sees the lamp's reflection, at (-1, -1, 0).
bool mirrors_lamp(const Model& model) {
  const double mirrored = seen(model, 0, {1, 1, 0});  // the direction from that eye to the disc
  for (const dvec3& eye : {dvec3(1, -1, 0), dvec3(0, -1, 0), dvec3(0, -1, 1), dvec3(0, -1, -1)}) {
    if (seen(model, 0, -eye) > mirrored - 0.02) return false;
  }
  return true;
}

TEST(BakedLight, GlossMirrorsLamp) {
  SceneBuilder stage;
  stage.disc({0, 0, 0}, facing_up, dvec3(0.01), {.colour = dvec3(0.2), .gloss = 3.0, .sharpness = 14});
  Model model = lit_by_lamp(stage);
  EXPECT_TRUE(mirrors_lamp(model));
  // Injected: directions from the Gaussian to the eye negate the odd degrees.
  for (std::size_t k : {1, 2, 3, 9, 10, 11, 12, 13, 14, 15}) {
    for (std::size_t c = 0; c < 3; ++c) model.sh[k * 3 + c] *= -1.0f;
  }
  EXPECT_FALSE(mirrors_lamp(model)) << "a turned direction goes unnoticed";
}

TEST(BakedLight, SolidsCastShadows) {
  // Each solid is half-way between a disc and the lamp; a second disc is not in its shadow. Without gloss,
  // all eyes see the same.
  for (const Solid::Shape shape : {Solid::Shape::box, Solid::Shape::ellipsoid, Solid::Shape::roof}) {
    SceneBuilder stage;
    stage.disc({0, 0, 0}, facing_up, dvec3(0.01), {.colour = dvec3(0.5)});
    stage.disc({0, 0, 1}, facing_up, dvec3(0.01), {.colour = dvec3(0.5)});
    const Model lit = lit_by_lamp(stage);
    stage.frame = turned({0.5, -0.5, 0}, 30.0);
    stage.solid(shape, dvec3(-0.1), dvec3(0.1));
    const Model shaded = lit_by_lamp(stage);
    EXPECT_GT(seen(lit, 0, {0, 1, 0}), 0.1);
    EXPECT_EQ(seen(lit, 0, {0, 1, 0}), seen(lit, 0, {-1, 2, 0.5}));
    EXPECT_LT(seen(shaded, 0, {0, 1, 0}), 0.01);
    EXPECT_EQ(seen(shaded, 1, {0, 1, 0}), seen(lit, 1, {0, 1, 0}));
  }
}

TEST(BakedLight, UnlitKeepsColour) {
  SceneBuilder stage;
  stage.disc({0, 0, 50}, facing_up, dvec3(1), {.colour = {0.2, 0.7, 0.3}, .lit = false});
  EXPECT_NEAR(seen(lit_by_lamp(stage), 0, {0, 0, 1}), 0.7, 1e-6);
}

}  // namespace
}  // namespace binosplat::demo
