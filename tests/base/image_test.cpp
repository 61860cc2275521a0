#include "base/image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace binosplat {
namespace {

// Returns four pixels: covered by 3/4, empty, covered by exactly a half, and opaque and brighter than white.
Picture four_pixels() {
  Picture picture(2, 2);
  picture.colour = {
      {0.3f, 0.0f, 0.75f, 0.25f}, {0, 0, 0, 1}, {0.1f, 0.2f, 0.3f, 0.5f}, {2.0f, 1.0f, 0.5f, 0.0f}};
  picture.z_sum = {3.0f, 0.0f, 1.0f, 5.0f};
  return picture;
}

TEST(Image, CompositesOverBackground) {
  const Image image = composite(four_pixels(), glm::vec3(1.0f, 0.5f, 0.0f));
  EXPECT_EQ(image.channels, 3);
  const float expected[] = {0.55f, 0.125f, 0.75f, 1.0f, 0.5f, 0.0f, 0.6f, 0.45f, 0.3f, 2.0f, 1.0f, 0.5f};
  for (std::size_t i = 0; i < 12; ++i) EXPECT_FLOAT_EQ(image.data[i], expected[i]) << i;
}

TEST(Image, KeepsStraightAlphaWithoutBackground) {
  const Image image = composite(four_pixels(), {});
  EXPECT_EQ(image.channels, 4);
  const float expected[] = {0.4f, 0.0f, 1.0f, 0.75f, 0,    0,    0,    0,
                            0.2f, 0.4f, 0.6f, 0.5f,  2.0f, 1.0f, 0.5f, 1.0f};
  for (std::size_t i = 0; i < 16; ++i) EXPECT_FLOAT_EQ(image.data[i], expected[i]) << i;
}

TEST(Image, DepthNeedsHalfCoverage) {
  const Image depth = depth_map(four_pixels());
  constexpr float none = std::numeric_limits<float>::infinity();
  EXPECT_EQ(depth.channels, 1);
  EXPECT_EQ(depth.data, (std::vector<float>{4.0f, none, none, 5.0f}));
}

TEST(Image, QuantisesByRoundingAndClamping) {
  Image image(4, 1, 1);
  image.data = {-1.0f, 1.5f, 0.499f / 255.0f, 0.501f / 255.0f};
  EXPECT_EQ(quantised(image).data, (std::vector<float>{0.0f, 1.0f, 0.0f, 1.0f / 255.0f}));
  image.data = {0.5f, 0.25f, 1e-5f, 0.0f};
  EXPECT_EQ(quantised(image, 65535).data,
            (std::vector<float>{32768.0f / 65535.0f, 16384.0f / 65535.0f, 1.0f / 65535.0f, 0.0f}));
}

TEST(Image, SameBitsDetectsAnyDifference) {
  const std::vector<Picture> pictures = {four_pixels(), four_pixels()};
  EXPECT_TRUE(same_bits(pictures, pictures));
  EXPECT_FALSE(same_bits(pictures, std::span(pictures).first(1)));
  const auto changed = [&](const std::function<void(Picture&)>& change) {
    std::vector<Picture> other = pictures;
    change(other[1]);
    return !same_bits(pictures, other);
  };
  EXPECT_TRUE(changed([](Picture& p) { p.colour[3].a = -0.0f; }));
  EXPECT_TRUE(changed([](Picture& p) { p.z_sum[2] = std::nextafter(1.0f, 2.0f); }));
  EXPECT_TRUE(changed([](Picture& p) { p.width = 4, p.height = 1; }));
}

}  // namespace
}  // namespace binosplat
