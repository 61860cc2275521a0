// Long thin Gaussians at a headset's focal lengths. They are thousands of pixels long and one pixel wide, so
// fp32 has no digits to spare.

#include <fmt/format.h>

#include "base/choices.h"
#include "render/faulty_shaders.h"
#include "render/support.h"

namespace binosplat {
namespace {

struct Needle {
  double length, width;  // standard deviations, metres
};
constexpr Needle shortest = {0.5, 0.0005}, longest = {20.0, 0.004};

// Returns 40 wires through the picture, 1 to 4 m away, in all directions.
Model wires(const Needle& needle, std::uint32_t seed, double kernel_px2 = KERNEL_PX2) {
  test::Uniform uniform(seed);
  Model model;
  model.name = "wires";
  model.degree = 0;
  model.kernel_px2 = kernel_px2;
  for (int n = 0; n < 40; ++n) {
    const double z = uniform(1.0, 4.0);
    const glm::vec3 position(uniform(-0.03, 0.03) * z, uniform(-0.03, 0.03) * z, z);
    const glm::vec4 rotation(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    const glm::vec3 colour(uniform(0, 1), uniform(0, 1), uniform(0, 1));
    test::add(model, position, glm::vec3(needle.length, needle.width, needle.width),
              static_cast<float>(uniform(0.3, 1.0)), colour, rotation);
  }
  return model;
}

shared::View view_of_focal(double focal) { return make_view(test::front_camera(128, 96, focal)); }

// Returns the lowest PSNR over needles, focal lengths and seeds. Injected faults show with fewer seeds.
double min_db(const render::FrameSettings& settings, double kernel_px2 = KERNEL_PX2,
              std::uint32_t seeds = 2) {
  double least = 1e9;
  for (const Needle& needle : {shortest, Needle{2, 0.001}, Needle{5, 0.002}, longest}) {
    for (const double focal : {300.0, 1536.0, 4000.0}) {
      for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
        const Model model = wires(needle, seed, kernel_px2);
        const double db = test::psnr(test::draw(model, view_of_focal(focal), settings),
                                     reference::render(model, view_of_focal(focal)));
        if (db < least) fmt::print("{} x {} m, {} px: {:.1f} dB\n", needle.length, needle.width, focal, db);
        least = std::min(least, db);
      }
    }
  }
  return least;
}

TEST(Needles, AreExactAtEveryFocalLength) {
  EXPECT_GE(min_db({}), 68.0);
  EXPECT_GE(min_db({}, 0.1), 68.0) << "Mip-Splatting's low-pass";
}

// Scales of diverged trainings: exp() of huge log-scales.
TEST(Needles, DivergedScalesAreExactOrSkipped) {
  for (const double length : {1e6, 1e9, 1e12}) {
    for (const Projection projection : {Projection::affine, Projection::tangent}) {
      Model model = wires({length, 0.004}, 1);
      model.perspective = {Order::distance, projection};
      const shared::View view = view_of_focal(1536.0);
      const Picture expected = reference::render(model, view);
      EXPECT_GE(test::psnr(test::draw(model, view), expected), 68.0) << length << " " << name_of(projection);
      for (glm::vec3& scale : model.scale) scale.y = scale.z = 0.0f;  // injected: without their width
      EXPECT_LT(test::psnr(test::draw(model, view), expected), 60.0) << length << " " << name_of(projection);
    }
  }
  Model one = wires({1.0, 0.004}, 1);
  const auto is_kept = [&](float scale) {
    return place(one, 0, {glm::vec3(0.0f), glm::vec3(scale, 1.0f, 1.0f), {1, 0, 0, 0}, 0.5f, one.sh.data()});
  };
  EXPECT_TRUE(is_kept(1e12f));
  EXPECT_FALSE(is_kept(1e19f));
}

TEST(Needles, NeedPreciseDeterminant) {
  const test::FaultyShaders fault(
      "projection.glsl", "precise float det = with_low_pass(det_p, low_pass, width, height, low.slope);",
      "precise float det = (dot_precise(a, a) + low_pass) * (dot_precise(d, d) + low_pass) - dot_precise(a, "
      "d) * dot_precise(a, d);");
  EXPECT_LT(min_db({}, KERNEL_PX2, 1), 45.0);
}

TEST(Needles, CoverEveryTile) {
  for (const Needle& needle : {shortest, longest}) {
    for (const double focal : {300.0, 4000.0}) {
      const Model model = wires(needle, 9);
      const Picture all = test::draw(model, view_of_focal(focal), {.tiles = TILES_ALL});
      for (const int tiles : test::exact_tiles)
        EXPECT_TRUE(test::same_bits(test::draw(model, view_of_focal(focal), {.tiles = tiles}), all)) << tiles;
    }
  }
}

TEST(Needles, Reach68DbInHalfPrecision) {
  EXPECT_GE(min_db({.precision = PRECISION_HALF}), 68.0);
  // Injected fault: the direction of the conic in fp16.
  const test::FaultyShaders fault("half_precision.glsl", "xx_yx.y + b_yx.y / HALF_FACTOR", "xx_yx.y");
  EXPECT_LT(min_db({.precision = PRECISION_HALF}, KERNEL_PX2, 1), 68.0);
}

}  // namespace
}  // namespace binosplat
