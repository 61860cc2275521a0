#include "demo/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace binosplat::demo {
namespace {

const Texture grey = Material{.colour = dvec3(0.5)};

/// Whether all axes are orthonormal and right-handed, and all normals point away from `centre`.
bool faces_outwards(const Stage& stage, const dvec3& centre) {
  for (const Disc& disc : stage.discs) {
    const dmat3 square = glm::transpose(disc.axes) * disc.axes;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        if (std::abs(square[i][k] - (i == k ? 1.0 : 0.0)) > 1e-9) return false;
      }
    }
    if (glm::determinant(disc.axes) < 0.0 || glm::dot(disc.axes[2], disc.position - centre) <= 0.0)
      return false;
  }
  return !stage.discs.empty();
}

TEST(Random, IsWrittenDown) {
  Random random(1234567);  // the numbers that SplitMix64's descriptions give for this seed
  EXPECT_EQ(random.bits(), 6457827717110365317ull);
  EXPECT_EQ(random.bits(), 3203168211198807973ull);
  for (int i = 0; i < 1000; ++i) {
    const double v = random.uniform(-2.0, 3.0);
    ASSERT_TRUE(v >= -2.0 && v < 3.0);
  }
}

TEST(Noise, IsSmoothAndWithinBounds) {
  for (int i = -50; i < 50; ++i) {
    const double x = 0.37 * i, y = 11.3 - 0.21 * i;
    ASSERT_TRUE(noise(x, y) >= 0.0 && noise(x, y) <= 1.0);
    ASSERT_TRUE(fractal(x, y) >= 0.0 && fractal(x, y) <= 1.0);
    ASSERT_NEAR(noise(x, y), noise(x + 1e-4, y), 5e-4);
  }
}

TEST(Stage, SurfacesFaceOutwards) {
  const Frame frame = rolled(turned({1, 2, 3}, 40.0), 25.0);
  Stage box(1);
  box.box(frame, dvec3(-0.3, -0.2, -0.1), dvec3(0.3, 0.2, 0.1), Grain(0.05), grey);
  EXPECT_TRUE(faces_outwards(box, frame.origin));
  Stage ball(1);
  ball.ellipsoid(frame, {0.3, 0.2, 0.1}, 0.03, grey);
  EXPECT_TRUE(faces_outwards(ball, frame.origin));
  Stage can(1);
  can.lathe(frame, {{0.0, -0.3}, {0.2, -0.3}, {0.2, 0.3}, {0.0, 0.3}}, 0.04, grey);
  EXPECT_TRUE(faces_outwards(can, frame.origin));
  can.discs[5].axes[2] *= -1.0;
  EXPECT_FALSE(faces_outwards(can, frame.origin)) << "a disc turned over goes unnoticed";
}

TEST(Stage, SheetsStayWithinTheirBorder) {
  Stage stage(1);
  stage.sheet({0, 0, 0}, {1, 0, 0}, {0, 0.5, 0}, {0.1, 0.05}, grey);
  stage.sheet({0, 0, 0}, {1, 0, 0}, {0, 0.5, 0}, {0.1, 0.05}, [](double u, double v) {
    EXPECT_TRUE(u > 0.0 && u < 1.0 && v > 0.0 && v < 0.5);
    return Material{.opacity = 0.0};
  });
  EXPECT_GT(stage.discs.size(), 50u);
  for (const Disc& disc : stage.discs) {
    EXPECT_GE(disc.position.x - disc.scale.x, -1e-9);
    EXPECT_LE(disc.position.x + disc.scale.x, 1.0 + 1e-9);
    EXPECT_EQ(disc.axes[2], dvec3(0, 0, 1));
  }
}

TEST(Stage, WiresAreLongAndThin) {
  Stage stage(1);
  stage.wire(curve({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, 0.05), 0.002, 0.02, {});
  EXPECT_NEAR(static_cast<double>(stage.discs.size()), 100.0, 15.0);
  for (const Disc& disc : stage.discs) EXPECT_GT(disc.scale.x, 8.0 * disc.scale.y);
}

TEST(Stage, HiddenDiscsAreRemoved) {
  Stage stage(1);
  const Frame frame = turned({1, 0, 0}, 30.0);
  stage.block(Solid::Shape::box, frame, dvec3(-0.1), dvec3(0.1));
  stage.disc(frame.at(0, 0, 0.09), dmat3(1), dvec3(0.01), {});  // inside
  stage.disc(frame.at(0, 0, 0.1), dmat3(1), dvec3(0.01), {});   // on a face
  stage.disc(frame.at(0, 0.2, 0), dmat3(1), dvec3(0.01), {});   // beside it
  stage.remove_hidden();
  EXPECT_EQ(stage.discs.size(), 2u);
}

}  // namespace
}  // namespace binosplat::demo
