#include "measure/comparison.h"

#include <gtest/gtest.h>

#include "support/models.h"

namespace binosplat {
namespace {

Image noise_pair(int channels, std::uint32_t seed) {
  Image image(13, 11, channels);
  test::Uniform uniform(seed);
  for (float& value : image.data) value = static_cast<float>(uniform(-0.2, 1.2));
  return image;
}

Image with_alpha(Image image, float alpha) {
  for (std::size_t i = 3; i < image.data.size(); i += 4) image.data[i] = alpha;
  return image;
}

const glm::vec3 green(0.1f, 0.8f, 0.2f);

TEST(ComparedPictures, TransparencyIsCompositedOverBackground) {
  const Image image = noise_pair(4, 1);
  const Image shown = measure::composite_over(green, image);
  ASSERT_EQ(shown.channels, 3);
  for (int y = 0; y < 11; ++y) {
    for (int x = 0; x < 13; ++x) {
      for (int c = 0; c < 3; ++c) {
        const double alpha = image.at(x, y, 3), v = alpha * image.at(x, y, c) + (1 - alpha) * green[c];
        EXPECT_NEAR(shown.at(x, y, c), v, 1e-6);
      }
    }
  }
  // Injected fault: premultiplied alpha, as in OpenEXR.
  EXPECT_GT(std::abs(shown.at(3, 3, 0) - (image.at(3, 3, 0) + (1 - image.at(3, 3, 3)) * green[0])), 1e-3);
  const Image grey = noise_pair(1, 2);
  const Image colour = measure::composite_over(green, grey);
  for (std::size_t i = 0; i < colour.data.size(); ++i) EXPECT_EQ(colour.data[i], grey.data[i / 3]);
}

/// The channels of two images after preparation, and whether a background was used.
struct Made {
  Image a, b;
  bool before_background = false;
};
Made made(Image a, Image b, const Background& background = {}) {
  const bool before_background = measure::prepare_comparison(a, b, background);
  return {std::move(a), std::move(b), before_background};
}

TEST(ComparedPictures, OpaqueAlphaIsDropped) {
  const Image opaque = with_alpha(noise_pair(4, 1), 1.0f), rgb = measure::composite_over(green, opaque);
  const Image grey = noise_pair(1, 3);
  for (const Image& other : {rgb, grey, with_alpha(noise_pair(4, 4), 1.0f)}) {
    for (const bool first : {true, false}) {
      const Made of = first ? made(opaque, other) : made(other, opaque);
      EXPECT_EQ(of.a.channels, 3);
      EXPECT_EQ(of.b.channels, 3);
      EXPECT_FALSE(of.before_background);
      EXPECT_EQ((first ? of.a : of.b).data, made(rgb, rgb).a.data);
    }
  }
}

TEST(ComparedPictures, SingleAlphaIsCompositedOverBlack) {
  const Image see_through = with_alpha(noise_pair(4, 1), 0.5f);
  for (const Image& other : {noise_pair(3, 2), noise_pair(1, 3)}) {
    const Made of = made(see_through, other);
    EXPECT_TRUE(of.before_background);
    const Image black = measure::composite_over(glm::vec3(0.0f), see_through);
    EXPECT_EQ(of.a.data, made(black, black).a.data);
    EXPECT_EQ(of.b.channels, 3);
    const Image on_green = measure::composite_over(green, see_through);
    EXPECT_EQ(made(see_through, other, green).a.data, made(on_green, on_green).a.data);
  }
}

TEST(ComparedPictures, AlphaOfBothIsCompared) {
  const Image a = with_alpha(noise_pair(4, 1), 0.5f), b = with_alpha(noise_pair(4, 1), 0.25f);
  const Made of = made(a, b);
  EXPECT_EQ(of.a.channels, 4);
  EXPECT_EQ(of.b.channels, 4);
  EXPECT_FALSE(of.before_background);
  EXPECT_NE(of.a.data, of.b.data);
  // Colours count as much as they are seen, so that of a transparent pixel does not.
  EXPECT_FLOAT_EQ(of.a.at(1, 1, 0), 0.5f * measure::clamped(noise_pair(4, 1)).at(1, 1, 0));
  EXPECT_EQ(made(with_alpha(noise_pair(4, 1), 0.0f), with_alpha(noise_pair(4, 2), 0.0f)).a.data,
            made(with_alpha(noise_pair(4, 2), 0.0f), with_alpha(noise_pair(4, 2), 0.0f)).a.data);
  // An opaque picture also keeps its alpha channel.
  EXPECT_EQ(made(a, with_alpha(noise_pair(4, 1), 1.0f)).b.channels, 4);
  // With a background, alpha disappears.
  EXPECT_EQ(made(a, b, green).a.channels, 3);
  EXPECT_TRUE(made(a, b, green).before_background);
}

TEST(ComparedPictures, GreyPairStaysGrey) {
  const Made of = made(noise_pair(1, 1), noise_pair(1, 2));
  EXPECT_EQ(of.a.channels, 1);
  EXPECT_EQ(of.b.channels, 1);
  for (const float v : of.a.data) EXPECT_TRUE(v >= 0.0f && v <= 1.0f);
}

}  // namespace
}  // namespace binosplat
