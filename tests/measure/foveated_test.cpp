// The visible difference of two pictures, compared with published measurements of eyes.

#include "measure/foveated.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>

#include "measure/metrics.h"
#include "support/errors.h"

namespace binosplat::measure {
namespace {

TEST(Foveated, ThresholdMatchesGeislerAndPerry) {
  // 1/64 at frequency 0; the resolution halves 2.3 degrees from the gaze.
  EXPECT_DOUBLE_EQ(contrast_threshold(0, 0), 1.0 / 64);
  // The finest gratings that are visible at full contrast.
  const std::pair<double, double> finest[] = {{0, 39.23}, {2.3, 39.23 / 2}, {20, 4.05}};
  for (const auto& [degrees, cycles] : finest)
    EXPECT_NEAR(contrast_threshold(cycles, degrees), 1.0, 0.02) << degrees;
}

TEST(Foveated, ThresholdMatchesMeasuredEyes) {
  // Contrast sensitivities measured by Wright and Johnston, Spatiotemporal contrast sensitivity and visual
  // field locus, 1983 (mean of their observers, gratings at rest), with cycles a degree and degrees.
  struct Measured {
    double frequency, eccentricity, sensitivity;
  };
  constexpr Measured measured[] = {
      {2, 0, 203.2}, {2, 2.69, 86.4}, {2, 5.38, 68.5}, {2, 8.04, 48.5}, {2, 10.66, 31.8}, {2, 11.96, 23.3},
      {6, 0, 147.5}, {6, 2.69, 40.2}, {6, 5.38, 21.7}, {6, 8.04, 10.9}, {6, 10.66, 4.0},  {6, 11.96, 2.6},
      {9, 0, 93.2},  {9, 1.91, 34.9}, {9, 3.81, 14.1}, {9, 5.9, 5.4},   {9, 7.78, 3.6}};
  // Large gratings at rest are visible at lower contrast than the model predicts, by about the same factor
  // everywhere.
  double sum = 0, squares = 0;
  for (const Measured& m : measured) {
    const double log = std::log10(m.sensitivity * contrast_threshold(m.frequency, m.eccentricity));
    sum += log;
    squares += log * log;
  }
  const double mean = sum / std::size(measured);
  EXPECT_NEAR(mean, 0.42, 0.02);
  EXPECT_LT(std::sqrt(squares / std::size(measured) - mean * mean), 0.15);
  // Injected: an eye with the same resolution everywhere.
  squares = sum = 0;
  for (const Measured& m : measured) {
    const double log = std::log10(m.sensitivity * contrast_threshold(m.frequency, 0));
    sum += log;
    squares += log * log;
  }
  EXPECT_GT(std::sqrt(squares / std::size(measured) - std::pow(sum / std::size(measured), 2)), 0.4);
}

constexpr int side = 256;

float to_display(double light) {
  return static_cast<float>(light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055);
}

// Returns a grating on grey, in cycles per pixel, with a contrast on a screen whose black emits some light.
Image grating(double cycles, double contrast) {
  Image out(side, side, 3);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const double light = 0.3 * (1 + contrast * std::cos(2 * std::acos(-1.0) * cycles * x));
      for (int c = 0; c < 3; ++c) out.at(x, y, c) = to_display((light - 0.005) / 0.995);
    }
  }
  return out;
}

TEST(Foveated, GratingIsVisibleFromThreshold) {
  const Gaze gaze{.x = side / 2.0, .y = side / 2.0, .fov_degrees = 12};
  const double focal = 0.5 * side / std::tan(glm::radians(6.0));
  const double ppd = glm::radians(1.0) * focal;
  for (const double cycles : {0.25, 0.125, 0.0625}) {
    const double threshold = contrast_threshold(cycles * ppd, 0);
    const Image times = times_threshold(grating(cycles, 2 * threshold), grating(cycles, 0), gaze);
    float most = 0;
    for (int y = side / 2 - 8; y < side / 2 + 8; ++y) {
      for (int x = side / 2 - 8; x < side / 2 + 8; ++x) most = std::max(most, times.at(x, y, 0));
    }
    EXPECT_NEAR(most, 2.0, 0.3) << cycles;
  }
}

TEST(Foveated, FineDetailIsVisibleNearGaze) {
  const Image fine = grating(0.25, 0.12), grey = grating(0.25, 0);
  for (const double at : {20.0, side - 20.0}) {
    const Gaze gaze{.x = at, .y = side / 2.0, .fov_degrees = 60};
    const FoveatedComparison found = compare_foveated(fine, grey, gaze);
    ASSERT_GE(found.rings.size(), 5u);
    EXPECT_GT(found.rings[0].visible, 0.3);
    EXPECT_LT(found.rings.back().visible, 0.1);  // little is visible except at the picture's border
    EXPECT_GT(found.rings[0].p99, found.rings[1].p99);
    // PSNR ignores the gaze: a grating differs from grey equally everywhere.
    EXPECT_NEAR(found.rings[1].psnr, psnr(fine, grey), 0.5);
    // Injected: an eye that looks elsewhere.
    const Image times = times_threshold(fine, grey, gaze);
    const auto column = static_cast<int>(at);
    EXPECT_GT(times.at(column, side / 2, 0), 2 * times.at(side - column, side / 2, 0));
  }
  double share = 0;
  for (const Ring& ring : compare_foveated(fine, grey, {side / 2.0, side / 2.0, 60}).rings)
    share += ring.share;
  EXPECT_NEAR(share, 1.0, 1e-12);
}

TEST(Foveated, EqualPicturesHaveNoVisibleDifference) {
  const Image grey = grating(0.1, 0.5);
  const FoveatedComparison found = compare_foveated(grey, grey, {3, 250, 90});
  EXPECT_EQ(found.visible, 0.0);
  for (const Ring& ring : found.rings) {
    EXPECT_TRUE(std::isinf(ring.psnr));
    EXPECT_EQ(ring.p99, 0.0);
  }
  const Image black(side, side, 3);
  EXPECT_EQ(compare_foveated(grey, black, {128, 128, 40}).visible, 1.0);  // shades, too
}

TEST(Foveated, RejectsInvalidGaze) {
  const Image grey(64, 32, 3);
  const auto said = [&](const Gaze& gaze) { return [=] { compare_foveated(grey, grey, gaze); }; };
  EXPECT_TRUE(test::fails_saying(said({65, 3, 90}), {"(65, 3)", "64 x 32"}));
  EXPECT_TRUE(test::fails_saying(said({std::nan(""), 3, 90}), {"gaze at (nan"}));
  EXPECT_TRUE(test::fails_saying(said({6, 3, 180}), {"180 degrees", "1 to 170"}));
  EXPECT_TRUE(test::fails_saying(
      [&] {
        compare_foveated(grey, Image(3, 3, 3), {1, 1, 90});
      },
      {"equal sizes"}));
}

}  // namespace
}  // namespace binosplat::measure
