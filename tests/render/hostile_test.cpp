// Models that break renderers: each right against the reference, with a fault that the comparison catches.

#include "support/hostile.h"

#include "reference/blend_pixel.h"
#include "render/support.h"
#include "stereo/rig.h"

namespace binosplat {
namespace {

using test::draw;
using test::psnr;

TEST(Hostile, ATileOfManySplatsIsNotCutByTheDriver) {
  const Camera camera = test::front_camera(48, 48, 64);
  const Model model = test::crowded_tile(camera, 1, 1);
  const shared::View view = make_view(camera);
  const Picture drawn = draw(model, view);
  EXPECT_GE(psnr(drawn, reference::render(model, view)), 80.0);
  // What llvmpipe's 65,535 rounds would leave of it is told apart.
  const auto splats = reference::project_all(model, view);
  auto order = reference::depth_order(splats);
  ASSERT_GT(order.size(), 70000u);
  order.resize(65535);
  const auto lists = reference::make_lists(splats, order, view, TILES_ELLIPSE);
  EXPECT_LT(psnr(drawn, reference::blend(splats, lists, view)), 60.0);
}

// Of as many tiles as a headset's pair has, in a quarter of its pixels.
TEST(Hostile, OneGaussianOverEveryTileOfAHeadsetPair) {
  const Model model = test::blanket();
  const Camera head =
      resized(stereo::apply_preset(test::front_camera(1280, 720, 600), "headset"), 1830, 1600);
  const auto rig = stereo::make_rig(head, {.ipd = 0.064, .convergence = 1.0});
  render::Frame frame(test::gl_context(), model);
  EXPECT_EQ(frame.draw(rig.views, {.tile_size = 8}).pairs, 2u * 229 * 200);
  const std::vector<Picture> eyes = frame.read_pictures();
  // The reference takes long for so many pixels: it has some of them.
  for (const std::size_t eye : {0, 1}) {
    const reference::Splat splat = reference::project(model, 0, rig.views[eye]);
    double off = 0.0, off_other = 0.0;
    for (int y = 5; y < head.height; y += TILE_SIZE_DEFAULT) {
      for (int x = 7; x < head.width; x += TILE_SIZE_DEFAULT) {
        const double light = 1.0 - reference::alpha_at(splat, x, y);
        const glm::dvec4 expected((1.0 - light) * splat.colour, light);
        const auto k = static_cast<std::size_t>(std::ptrdiff_t{y} * head.width + x);
        off = std::max(off, glm::length(glm::dvec4(eyes[eye].colour[k]) - expected));
        off_other = std::max(off_other, glm::length(glm::dvec4(eyes[1 - eye].colour[k]) - expected));
      }
    }
    EXPECT_LE(off, 1e-5);
    EXPECT_GT(off_other, 1e-4) << "the other eye's goes unnoticed";
  }
}

TEST(Hostile, EqualDepthsAreInTheOrderOfTheirIndices) {
  const shared::View view = make_view(test::front_camera(96, 96, 96));
  const Picture drawn = draw(test::equal_depths(), view);
  EXPECT_GE(psnr(drawn, reference::render(test::equal_depths(), view)), 90.0);
  EXPECT_LT(psnr(drawn, reference::render(test::equal_depths(300, true), view)), 60.0);
}

TEST(Hostile, OutliersTwentyMillionUnitsAwayLeaveTheRestAlone) {
  const shared::View view = make_view(test::front_camera(160, 120, 150));
  const Picture drawn = draw(test::far_outliers(), view);
  EXPECT_GE(psnr(drawn, reference::render(test::far_outliers(), view)), 80.0);
  EXPECT_LT(psnr(drawn, reference::render(test::far_outliers(false), view)), 60.0);
}

TEST(Hostile, WhatIsBelowTauLeavesNoMark) {
  const Camera camera = test::front_camera(64, 48, 64);
  const shared::View view = make_view(camera);
  for (const float opacity : {0.0f, test::just_below_tau}) {
    for (int tiles = 0; tiles < std::ssize(tiles_choices); ++tiles) {
      for (const glm::vec4& c : draw(test::transparent(camera, opacity), view, {.tiles = tiles}).colour) {
        EXPECT_EQ(c, glm::vec4(0, 0, 0, 1)) << tiles_choices[tiles].name << " " << opacity;
      }
    }
  }
}

TEST(Hostile, WhatIsAboveTauLeavesItsMark) {
  const Camera camera = test::front_camera(64, 48, 64);
  const shared::View view = make_view(camera);
  const float opacity = 1.01f / 255.0f;
  const Picture drawn = draw(test::transparent(camera, opacity, 2000), view);
  EXPECT_GE(psnr(drawn, reference::render(test::transparent(camera, opacity, 2000), view)), 80.0);
  EXPECT_LT(psnr(drawn, Picture(64, 48)), 60.0);
}

TEST(Hostile, ExactlyTauMarksOnePixel) {
  const Camera camera = test::front_camera(64, 48, 64);
  for (int tiles = 0; tiles < std::ssize(tiles_choices); ++tiles) {
    if (!render::has_every_pair(tiles)) continue;
    const Picture drawn = draw(test::exactly_tau(camera), make_view(camera), {.tiles = tiles});
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) {
        const double expected = x == 32 && y == 24 ? 1.0 / 255.0 : 0.0;
        EXPECT_NEAR(drawn.colour[static_cast<std::size_t>(y) * 64 + x].r, expected, 1e-7) << x << " " << y;
      }
    }
  }
}

}  // namespace
}  // namespace binosplat
