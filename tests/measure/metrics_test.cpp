#include "measure/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "support/errors.h"

namespace binosplat::measure {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

Image filled(int width, int height, int channels, float value) {
  Image image(width, height, channels);
  for (float& v : image.data) v = value;
  return image;
}

Image even_noise(int width, int height, int channels, std::uint32_t seed) {
  std::mt19937 engine(seed);
  Image image(width, height, channels);
  for (float& v : image.data) v = static_cast<float>(engine() * 0x1p-32);
  return image;
}

TEST(Psnr, MatchesHandCalculation) {
  // An error of 0.1 everywhere is 20 dB. In one of 100 values it is 40 dB.
  EXPECT_NEAR(psnr(filled(5, 4, 3, 0.5f), filled(5, 4, 3, 0.6f)), 20.0, 1e-5);
  Image one = filled(10, 10, 1, 0.5f);
  one.at(3, 7, 0) = 0.6f;
  EXPECT_NEAR(psnr(filled(10, 10, 1, 0.5f), one), 40.0, 1e-5);
  // Eight bits: one level of error everywhere is 20 log10(255).
  const Image grey = quantised(filled(8, 8, 3, 0.4f));
  EXPECT_NEAR(psnr(grey, filled(8, 8, 3, grey.data[0] + 1.0f / 255)), 48.1308, 1e-4);
}

TEST(Psnr, CombinesMeanSquaredErrors) {
  // Two pictures. The second has a third of the first's pixels, and an error of 0.1 in all of them: the mean
  // square is 0.01 / 4.
  const std::vector<Picture> black = {Picture(4, 3), Picture(4, 1)};
  std::vector<Picture> other = black;
  for (glm::vec4& colour : other[1].colour) colour = {0.1f, 0.1f, 0.1f, 1.0f};
  EXPECT_NEAR(psnr(black, other, glm::vec3(0.0f)), 20.0 + 10.0 * std::log10(4.0), 1e-4);
  EXPECT_EQ(psnr(black, black, glm::vec3(0.0f)), infinite);
  EXPECT_THROW(psnr(black, std::span(other).first(1), glm::vec3(0.0f)), Error);
}

TEST(Psnr, EqualIsInfinite) {
  const Image image = even_noise(7, 5, 3, 1);
  EXPECT_EQ(psnr(image, image), infinite);
  Image other = image;
  other.at(6, 4, 2) = std::nextafter(other.at(6, 4, 2), 0.0f);
  EXPECT_LT(psnr(image, other), infinite) << "the smallest difference in the last value goes unnoticed";
}

TEST(Psnr, ClampsAndDoesNotRound) {
  EXPECT_EQ(psnr(filled(4, 4, 3, 1.5f), filled(4, 4, 3, 1.0f)), infinite);
  EXPECT_EQ(psnr(filled(4, 4, 3, -0.5f), filled(4, 4, 3, 0.0f)), infinite);
  EXPECT_NEAR(psnr(filled(4, 4, 3, 0.5f), filled(4, 4, 3, 0.5001f)), 80.0, 1e-2);
}

TEST(Psnr, NanIsNotEqual) {
  Image image = filled(4, 4, 3, 0.5f);
  image.at(1, 1, 1) = not_a_number;
  EXPECT_EQ(psnr(image, filled(4, 4, 3, 0.5f)), -infinite);
  EXPECT_EQ(psnr(image, image), -infinite);
}

/// Returns SSIM in two dimensions, straight from its definition. It is slow and uses nothing of metrics.cpp.
double ssim_2d(const Image& a, const Image& b, double sigma = 1.5) {
  double weights[11][11], total = 0.0;
  for (int j = 0; j < 11; ++j) {
    for (int i = 0; i < 11; ++i) {
      weights[j][i] = std::exp(-((i - 5) * (i - 5) + (j - 5) * (j - 5)) / (2 * sigma * sigma));
      total += weights[j][i];
    }
  }
  double sum = 0.0;
  int count = 0;
  for (int c = 0; c < a.channels; ++c) {
    for (int y = 5; y < a.height - 5; ++y) {
      for (int x = 5; x < a.width - 5; ++x) {
        const auto average = [&](const auto& of) {
          double value = 0.0;
          for (int j = -5; j <= 5; ++j) {
            for (int i = -5; i <= 5; ++i) {
              value += weights[j + 5][i + 5] / total * of(a.at(x + i, y + j, c), b.at(x + i, y + j, c));
            }
          }
          return value;
        };
        const double ma = average([](double va, double) { return va; });
        const double mb = average([](double, double vb) { return vb; });
        const double saa = average([&](double va, double) { return (va - ma) * (va - ma); });
        const double sbb = average([&](double, double vb) { return (vb - mb) * (vb - mb); });
        const double sab = average([&](double va, double vb) { return (va - ma) * (vb - mb); });
        const double c1 = 1e-4, c2 = 9e-4;
        sum += (2 * ma * mb + c1) * (2 * sab + c2) / ((ma * ma + mb * mb + c1) * (saa + sbb + c2));
        ++count;
      }
    }
  }
  return sum / count;
}

TEST(Ssim, MatchesDefinition) {
  for (const auto& [width, height, channels] :
       {std::array{23, 17, 3}, std::array{11, 11, 1}, std::array{12, 40, 4}}) {
    const Image a = even_noise(width, height, channels, 5), b = even_noise(width, height, channels, 6);
    Image near = a;
    for (std::size_t k = 0; k < near.data.size(); ++k) near.data[k] = 0.8f * a.data[k] + 0.2f * b.data[k];
    EXPECT_NEAR(ssim(a, b), ssim_2d(a, b), 1e-12);
    EXPECT_NEAR(ssim(a, near), ssim_2d(a, near), 1e-12);
    EXPECT_GT(std::abs(ssim(a, near) - ssim_2d(a, near, 1.6)), 1e-5) << "another window goes unnoticed";
  }
}

TEST(Ssim, MatchesHandCalculation) {
  const Image image = even_noise(20, 20, 3, 9);
  EXPECT_EQ(ssim(image, image), 1.0);
  // In flat pictures only the term of the means remains: (2 * 0.5 * 0.6 + c1) / (0.25 + 0.36 + c1).
  EXPECT_NEAR(ssim(filled(15, 15, 1, 0.5f), filled(15, 15, 1, 0.6f)), 0.6001 / 0.6101, 1e-7);
  EXPECT_EQ(ssim(filled(15, 15, 1, 1.5f), filled(15, 15, 1, 1.0f)), 1.0) << "values are clamped";
  // A negative has the opposite sign of structure.
  Image negative = image;
  for (float& v : negative.data) v = 1.0f - v;
  EXPECT_LT(ssim(image, negative), -0.8);
}

TEST(Ssim, IsNanWhereUndefined) {
  EXPECT_TRUE(std::isnan(ssim(filled(10, 30, 3, 0.5f), filled(10, 30, 3, 0.5f))));
  Image image = filled(11, 11, 1, 0.5f);
  image.at(5, 5, 0) = not_a_number;
  EXPECT_TRUE(std::isnan(ssim(image, image)));
}

TEST(Difference, LocatesLargest) {
  Image a = even_noise(9, 6, 3, 3), b = a;
  EXPECT_EQ(largest_difference(a, b).max, 0.0);
  b.at(2, 1, 0) += 0.25f;
  b.at(7, 4, 2) = a.at(7, 4, 2) - 0.75f;
  const Difference largest = largest_difference(a, b);
  EXPECT_NEAR(largest.max, 0.75, 1e-6);
  EXPECT_EQ(largest.x, 7);
  EXPECT_EQ(largest.y, 4);
  EXPECT_EQ(largest.channel, 2);
  b.at(8, 5, 1) = not_a_number;
  EXPECT_EQ(largest_difference(a, b).max, infinite);
  EXPECT_EQ(largest_difference(a, b).x, 8);
}

TEST(Difference, IsUnclampedByDefault) {
  const Image a = filled(3, 3, 3, 2.5f), b = filled(3, 3, 3, 1.0f);
  EXPECT_NEAR(largest_difference(a, b).max, 1.5, 1e-7);
  EXPECT_EQ(largest_difference(clamped(a), clamped(b)).max, 0.0);
}

TEST(Difference, CommonErrorIgnoresFewPixels) {
  Image a = filled(100, 100, 1, 0.5f), b = filled(100, 100, 1, 0.51f);
  for (int x = 0; x < 9; ++x) b.at(x, 0, 0) = 1.0f;
  EXPECT_NEAR(common_error(a, b), 0.01, 1e-6);
  EXPECT_EQ(difference_gain(common_error(a, b)), 64.0);
  EXPECT_EQ(difference_gain(largest_difference(a, b).max), 2.0) << "the largest one hides all others";
  for (int x = 0; x < 20; ++x) b.at(x, 1, 0) = 1.0f;
  EXPECT_NEAR(common_error(a, b), 0.5, 1e-6);
  Image c = a;
  c.at(3, 3, 0) = 0.75f;
  EXPECT_NEAR(common_error(a, c), 0.25, 1e-6) << "one pixel that differs is all there is to show";
  EXPECT_EQ(common_error(a, a), 0.0);
}

TEST(Difference, PictureAppliesGain) {
  EXPECT_EQ(difference_gain(0.0), 1.0);
  EXPECT_EQ(difference_gain(1.0), 1.0);
  EXPECT_EQ(difference_gain(0.3), 2.0);
  EXPECT_EQ(difference_gain(1.0 / 255), 128.0);
  Image a = filled(4, 4, 3, 0.5f), b = a;
  b.at(1, 2, 0) = 0.625f;
  b.at(2, 2, 1) = 0.25f;
  b.at(3, 3, 2) = not_a_number;
  const Image picture = difference_picture(a, b, 4.0);
  EXPECT_FLOAT_EQ(picture.at(1, 2, 0), 0.5f);
  EXPECT_FLOAT_EQ(picture.at(1, 2, 1), 0.0f);
  EXPECT_FLOAT_EQ(picture.at(2, 2, 1), 1.0f);
  EXPECT_FLOAT_EQ(picture.at(3, 3, 2), 1.0f);
  // A difference of alpha alone is visible in the difference picture, which has no alpha.
  Image c = filled(2, 2, 4, 0.5f), d = c;
  d.at(1, 1, 3) = 0.75f;
  const Image of_alpha = difference_picture(c, d, 2.0);
  EXPECT_EQ(of_alpha.channels, 3);
  EXPECT_FLOAT_EQ(of_alpha.at(1, 1, 0), 0.5f);
  EXPECT_FLOAT_EQ(of_alpha.at(0, 0, 0), 0.0f);
}

TEST(Metrics, RejectIncomparablePictures) {
  const Image a = filled(12, 13, 3, 0.5f);
  for (const Image& other : {filled(13, 12, 3, 0.5f), filled(12, 13, 4, 0.5f)}) {
    EXPECT_THROW(psnr(a, other), Error);
    EXPECT_THROW(ssim(a, other), Error);
    EXPECT_THROW(largest_difference(a, other), Error);
    EXPECT_THROW(difference_picture(a, other, 1.0), Error);
  }
  EXPECT_THROW(psnr(Image{}, Image{}), Error);
  EXPECT_ERROR(psnr(a, filled(13, 12, 3, 0.5f)), "12 x 13 and 13 x 12");
}

}  // namespace
}  // namespace binosplat::measure
