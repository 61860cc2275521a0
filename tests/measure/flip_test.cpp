#include "measure/flip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "formats/pictures/image_file.h"

namespace binosplat::measure {
namespace {

Image flat(int width, int height, glm::vec3 rgb) {
  Image image(width, height, 3);
  for (std::size_t k = 0; k < image.data.size(); ++k) image.data[k] = rgb[static_cast<int>(k % 3)];
  return image;
}

Image published(const std::string& name) {
  return load_image(std::string(BINOSPLAT_SOURCE_DIR) + "/tests/measure/flip/" + name);
}

double largest(const Image& map) { return *std::max_element(map.data.begin(), map.data.end()); }

// The output of the authors' tool, to its six digits; it computes in fp32 (flip/README.md).
TEST(Flip, MatchesPublishedValues) {
  const Image reference = published("reference.png"), test = published("test.png");
  const Image map = flip_map(reference, test);
  EXPECT_NEAR(flip(reference, test), 0.133285, 2e-6);
  EXPECT_NEAR(largest(map), 0.983044, 2e-6);
  EXPECT_EQ(*std::min_element(map.data.begin(), map.data.end()), 0.0f);
  // The limits are narrow enough to detect a slightly nearer viewer, and channels in the wrong order.
  EXPECT_GT(std::abs(flip(reference, test, 66.5) - 0.133285), 1e-4);
  Image swapped = test;
  for (std::size_t k = 0; k < swapped.data.size(); k += 3) std::swap(swapped.data[k], swapped.data[k + 2]);
  EXPECT_GT(std::abs(flip(reference, swapped) - 0.133285), 1e-2);
}

Image first_rows(const Image& image, int rows) {
  Image part(image.width, rows, image.channels);
  std::copy_n(image.data.begin(), part.data.size(), part.data.begin());
  return part;
}

TEST(Flip, IsSymmetricAndZeroForEqual) {
  const Image reference = first_rows(published("reference.png"), 64),
              test = first_rows(published("test.png"), 64);
  EXPECT_EQ(flip(reference, reference), 0.0);
  EXPECT_EQ(flip(reference, test), flip(test, reference));
  Image other = flat(40, 30, {0.5f, 0.5f, 0.5f});
  other.at(20, 15, 1) = 0.51f;
  EXPECT_GT(flip(flat(40, 30, {0.5f, 0.5f, 0.5f}), other), 0.0);
}

// Flat pictures have no features and pass the filters unchanged, so the error is the distance of two colours.
TEST(Flip, FlatColoursMatchHandCalculation) {
  EXPECT_NEAR(flip(flat(24, 24, {0, 1, 0}), flat(24, 24, {0, 0, 1})), 1.0, 1e-6) << "the largest there is";
  // Green has L* 87.7355 and Hunt's a, b -75.6119, 72.9842; blue 32.3009 and 25.5808, -34.8383: 55.4346 apart
  // in lightness and 147.8703 in chroma. Their sum to the power of 0.7 is 41.2766.
  const double c_max = 41.2766, usual = 0.4 * c_max;
  // Black has L* 0, white 100: 100^0.7 is 25.1189.
  EXPECT_NEAR(flip(flat(24, 24, {0, 0, 0}), flat(24, 24, {1, 1, 1})),
              0.95 + 0.05 * (25.1189 - usual) / (c_max - usual), 1e-5);
  // Grey of 0.5 has L* 53.3890, of 0.535 56.8681: 3.4792^0.7 is 2.3935.
  EXPECT_NEAR(flip(flat(24, 24, {0.5f, 0.5f, 0.5f}), flat(24, 24, {0.535f, 0.535f, 0.535f})),
              0.95 * 2.3935 / usual, 1e-5);
}

// A fine pattern, compared with a flat colour of the same mean light: 0.5 is a light of 0.2140, and 0.6872
// one of 0.4281, twice as much. With more pixels per degree a viewer is farther away, and sees less of the
// pattern.
TEST(Flip, DecreasesWithViewingDistance) {
  Image pattern = flat(64, 64, glm::vec3(0.0f));
  for (int y = 0; y < 64; ++y) {
    for (int x = y % 2; x < 64; x += 2) {
      for (int c = 0; c < 3; ++c) pattern.at(x, y, c) = 0.6872f;
    }
  }
  const Image mean = flat(64, 64, glm::vec3(0.5f));
  EXPECT_LT(flip(pattern, mean, 120.0), 0.5 * flip(pattern, mean, 30.0));
  EXPECT_LT(flip(pattern, mean, 30.0), flip(pattern, mean, 8.0));
}

TEST(Flip, AcceptsGreyAndAlpha) {
  Image grey_a(32, 32, 1), grey_b(32, 32, 1);
  for (std::size_t k = 0; k < grey_a.data.size(); ++k) {
    grey_a.data[k] = static_cast<float>(k % 7) / 7.0f;
    grey_b.data[k] = static_cast<float>(k % 5) / 5.0f;
  }
  Image a(32, 32, 3), b(32, 32, 3);
  for (std::size_t k = 0; k < a.data.size(); ++k) {
    a.data[k] = grey_a.data[k / 3];
    b.data[k] = grey_b.data[k / 3];
  }
  EXPECT_EQ(flip(grey_a, grey_b), flip(a, b));

  // Black and half transparent: no difference over black, one over white. For white it is the other way
  // round.
  for (const float colour : {0.0f, 1.0f}) {
    Image opaque(24, 24, 4);
    for (std::size_t k = 0; k < opaque.data.size(); ++k) opaque.data[k] = k % 4 == 3 ? 1.0f : colour;
    Image half = opaque;
    for (std::size_t k = 3; k < half.data.size(); k += 4) half.data[k] = 0.5f;
    const glm::vec3 solid(colour);
    EXPECT_NEAR(flip(opaque, half), flip(flat(24, 24, solid), flat(24, 24, glm::vec3(0.5f))), 1e-6);
    EXPECT_EQ(flip(half, half), 0.0);
  }
}

TEST(Flip, NanIsNotEqual) {
  for (const int channels : {1, 3, 4}) {
    Image a(30, 30, channels);
    Image b = a;
    b.at(12, 14, channels - 1) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(std::isnan(flip(a, b))) << channels;
    EXPECT_TRUE(std::isnan(flip(b, b))) << channels;
  }
}

TEST(Flip, RejectsIncomparablePictures) {
  const Image a = flat(12, 13, glm::vec3(0.5f));
  EXPECT_THROW(flip(a, flat(13, 12, glm::vec3(0.5f))), Error);
  EXPECT_THROW(flip(Image{}, Image{}), Error);
  for (const double ppd : {0.0, -67.0, 0.5, 1001.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(flip(a, a, ppd), Error);
  EXPECT_EQ(flip(a, a, 1.0), 0.0);
}

}  // namespace
}  // namespace binosplat::measure
