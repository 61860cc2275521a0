// What the stability study says of a frame, on pictures whose errors are known.

#include "lab/judge.h"

#include <gtest/gtest.h>

#include <cmath>

#include "stereo/rig.h"
#include "support/errors.h"
#include "support/models.h"

namespace binosplat::lab {
namespace {

constexpr int width = 64, height = 48;

std::vector<shared::View> judged_views() { return {make_view(test::front_camera(width, height, 60))}; }

Picture grey() {
  Picture picture(width, height);
  picture.colour.assign(picture.colour.size(), glm::vec4(0.5f, 0.5f, 0.5f, 0.0f));
  picture.z_sum.assign(picture.z_sum.size(), 2.0f);
  return picture;
}

void stain(Picture& picture, int x, int y, float by) {
  picture.colour[static_cast<std::size_t>(y) * width + x] += glm::vec4(by, by, by, 0.0f);
}

FrameErrors judged(const Picture& approximate) {
  return judge(judged_views(), std::vector{grey()}, std::vector{approximate}, 16);
}

TEST(Judge, EqualFramesHaveNoError) {
  const FrameErrors errors = judged(grey());
  EXPECT_TRUE(std::isinf(errors.psnr));
  EXPECT_EQ(errors.largest, 0.0);
  EXPECT_EQ(errors.signed_mean, 0.0);
  EXPECT_EQ(errors.edges, 1.0);
  EXPECT_TRUE(std::isnan(errors.disagreement));
}

TEST(Judge, SaysHowMuchAndWhichWay) {
  Picture darker = grey();
  for (int x = 0; x < width; ++x) {
    for (int y = 0; y < height; ++y) stain(darker, x, y, -0.1f);
  }
  stain(darker, 5, 5, -0.2f);
  const FrameErrors errors = judged(darker);
  const double pixels = width * height;
  EXPECT_NEAR(errors.psnr, -10 * std::log10(((pixels - 1) * 0.01 + 0.09) / pixels), 1e-3);
  EXPECT_NEAR(errors.largest, 0.3, 1e-6);
  EXPECT_NEAR(errors.p99, 0.1, 1e-6);
  EXPECT_NEAR(errors.signed_mean, -0.1 - 0.2 / pixels, 1e-6);
  EXPECT_NEAR(errors.edges, 1.0, 0.05);
}

TEST(Judge, TellsErrorsAtTheEdgesOfTiles) {
  Picture seam = grey(), middle = grey();
  for (int y = 0; y < height; ++y) {
    stain(seam, 16, y, 0.05f);
    stain(middle, 24, y, 0.05f);
  }
  EXPECT_GT(judged(seam).edges, 2.0);
  EXPECT_LT(judged(middle).edges, 1.0);
}

TEST(Judge, WhatIsBrighterThanWhiteIsWhite) {
  Picture bright = grey(), brighter = grey();
  stain(bright, 3, 3, 0.6f);
  stain(brighter, 3, 3, 0.9f);
  EXPECT_TRUE(std::isinf(judge(judged_views(), std::vector{bright}, std::vector{brighter}, 16).psnr));
}

TEST(Judge, TwoEyesHaveADisagreement) {
  const auto rig = stereo::make_rig(test::front_camera(width, height, 60), {.ipd = 0.06});
  const std::vector<Picture> exact = {grey(), grey()};
  std::vector<Picture> approximate = exact;
  stain(approximate[1], 30, 20, 0.2f);
  const FrameErrors errors = judge(rig.views, exact, approximate, 16);
  EXPECT_NEAR(errors.psnr, -10 * std::log10(0.04 / (2 * width * height)), 1e-3);
  EXPECT_LT(errors.disagreement, errors.psnr);
}

TEST(Judge, PicturesThatDoNotFitAreRefused) {
  EXPECT_TRUE(test::fails_saying([] { judge(judged_views(), std::vector{grey()}, {}, 16); }, {"1 exact"}));
  const std::vector<Picture> small = {Picture(4, 4)};
  EXPECT_TRUE(test::fails_saying([&] { judge(judged_views(), std::vector{grey()}, small, 16); }, {"4 x 4"}));
}

}  // namespace
}  // namespace binosplat::lab
