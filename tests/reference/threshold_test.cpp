#include "reference/adagscale_threshold.h"

#include <gtest/gtest.h>

#include "reference/splats.h"
#include "support/errors.h"

namespace binosplat::reference {
namespace {

TEST(Threshold, OneSplatMatchesHandCalculation) {
  const Splat splat = make_splat({8, 8}, {5, 2, 4}, 1.0);  // det = 16, sqrt(det) = 4
  EXPECT_EQ(threshold(Threshold::exact, 2.0, splat, 0.5), 1.0 / 255);
  // 2 / (2 pi 4) = 0.0795775, and twice that if T is a half.
  EXPECT_NEAR(threshold(Threshold::adagscale, 2.0, splat, 1.0), 0.0795775 + 1.0 / 255, 1e-7);
  EXPECT_NEAR(threshold(Threshold::adagscale, 2.0, splat, 0.5), 0.1591549 + 1.0 / 255, 1e-7);
  // S = pi 4 = 12.56637: sqrt(0.1 / S) = 0.0892062.
  EXPECT_NEAR(threshold(Threshold::squared, 0.1, splat, 1.0), 0.0892062, 1e-7);
  EXPECT_NEAR(threshold(Threshold::squared, 0.1, splat, 0.5), 0.1784124, 1e-7);
  EXPECT_EQ(threshold(Threshold::squared, 1e-4, splat, 1.0), 1.0 / 255) << "0.00282 is less than tau";
  // sqrt(det) = 100: the area of 314 px is limited to 256 px; sqrt(0.1 / 256) = 0.0197642.
  const Splat large = make_splat({8, 8}, {100, 0, 100}, 1.0);
  EXPECT_NEAR(threshold(Threshold::squared, 0.1, large, 1.0), 0.0197642, 1e-7);
  EXPECT_NEAR(threshold(Threshold::adagscale, 2.0, large, 1.0), 0.0031831 + 1.0 / 255, 1e-7);
  for (const Threshold rule : {Threshold::exact, Threshold::adagscale, Threshold::squared}) {
    EXPECT_EQ(threshold(rule, 0.0, splat, 0.01), 1.0 / 255);
  }
}

TEST(Threshold, NearSplatDiffersBetweenEyes) {
  // 1 m in front of the eyes and 0.3 m to the right, 0.02 m large. The eyes are 0.2 m apart; fx = fy = 100
  // px. In the left eye x / z = 0.4: C2 = (4 (1 + 0.16) + 0.3, 0, 4 + 0.3). In the right eye x / z = 0.2.
  Model model;
  test::add(model, {0.3f, 0, 1}, glm::vec3(0.02f), 0.9f);
  const double dets[] = {4.94 * 4.3, 4.46 * 4.3};
  double of_eyes[2];
  for (int eye = 0; eye < 2; ++eye) {
    Camera camera = test::front_camera(100, 100, 100);
    camera.position.x = eye == 0 ? -0.1 : 0.1;
    const Splat splat = project(model, 0, make_view(camera));
    EXPECT_NEAR(splat.det, dets[eye], 1e-5);
    of_eyes[eye] = threshold(Threshold::adagscale, 2.0, splat, 1.0);
    EXPECT_NEAR(of_eyes[eye], 2.0 / (2 * M_PI * std::sqrt(dets[eye])) + 1.0 / 255, 1e-8);
    EXPECT_NEAR(threshold(Threshold::squared, 0.1, splat, 1.0),
                std::sqrt(0.1 / (M_PI * std::sqrt(dets[eye]))), 1e-8);
  }
  EXPECT_NEAR(of_eyes[0], 0.0729859, 1e-6);
  EXPECT_NEAR(of_eyes[1], 0.0766073, 1e-6);
}

TEST(Threshold, RejectsInvalidBounds) {
  const Splat splat = make_splat({8, 8}, {4, 0, 4}, 1.0);
  for (const double bound : {0.0, -1.0, std::nan("")}) {
    EXPECT_ERROR(threshold(Threshold::adagscale, 1.0, splat, bound), "a number above 0");
  }
  EXPECT_ERROR(threshold(static_cast<Threshold>(9), 1.0, splat, 1.0), "threshold 9");
  std::vector<Splat> splats = {splat};
  const std::vector<double> two = {1.0, 1.0};
  EXPECT_ERROR(set_thresholds(splats, Threshold::adagscale, 1.0, two), "2", "1");
}

TEST(Threshold, AboveOpacitySkipsSplat) {
  const shared::View view = view_of(64, 64);
  // Th is 0.0835 by the paper's rule and 0.0892 by the squared one.
  for (const auto& [rule, tolerance] : {std::pair(Threshold::adagscale, 2.0), {Threshold::squared, 0.1}}) {
    const std::vector<Splat> before = {make_splat({24, 24}, {4, 0, 4}, 0.08),
                                       make_splat({24, 24}, {4, 0, 4}, 0.09),
                                       make_splat({24, 24}, {4, 0, 4}, 0.003)};
    std::vector<Splat> splats = before;
    set_thresholds(splats, rule, tolerance);
    for (const int tiles : {TILES_AABB, TILES_OBB, TILES_SNUG, TILES_ELLIPSE, TILES_ALL}) {
      // The order may be made before or after the thresholds: lists skip splats that are not drawn.
      for (const auto& order : {depth_order(before), depth_order(splats)}) {
        const TileLists lists = make_lists(splats, order, view, tiles);
        EXPECT_GE(lists.pairs(), 1u);
        for (const std::uint32_t i : lists.gaussians) EXPECT_EQ(i, 1u);
      }
      EXPECT_FALSE(touches(splats[0], tiles, 1, 1, view));
    }
  }
  // With tau, aabb and all skip no splat.
  std::vector<Splat> faint = {make_splat({24, 24}, {4, 0, 4}, 0.003)};
  set_thresholds(faint, Threshold::exact, 2.0);
  EXPECT_EQ(make_lists(faint, {0}, view, TILES_AABB).pairs(), 1u);
  EXPECT_EQ(make_lists(faint, {0}, view, TILES_ALL).pairs(), 16u);
  for (const Threshold rule : {Threshold::adagscale, Threshold::squared}) {
    set_thresholds(faint, rule, 0.0);
    EXPECT_EQ(make_lists(faint, {0}, view, TILES_AABB).pairs(), 0u) << "Th = tau exceeds the opacity";
    faint[0].drawn = true;
  }
}

TEST(Threshold, ZeroToleranceEqualsTau) {
  const Model model = test::random_model(3, 800, 1);
  const shared::View view = view_of(75, 53);
  test::Uniform uniform(1);
  std::vector<double> bounds(model.count());
  for (double& value : bounds) value = uniform(0.01, 1.0);
  for (const int tiles : {TILES_SNUG, TILES_ELLIPSE}) {
    const Picture exact = render(model, view, {.tiles = tiles});
    for (const Threshold rule : {Threshold::adagscale, Threshold::squared}) {
      EXPECT_TRUE(
          equal_bits(render(model, view, {.tiles = tiles, .threshold = rule, .tolerance = 0.0}), exact));
      EXPECT_TRUE(
          equal_bits(render(model, view, {.tiles = tiles, .threshold = rule, .bounds = bounds}), exact));
      // The tolerance and the bounds have an effect.
      const Picture lossy = render(model, view, {.tiles = tiles, .threshold = rule, .tolerance = 0.01});
      EXPECT_FALSE(equal_bits(lossy, exact));
      EXPECT_FALSE(equal_bits(
          render(model, view, {.tiles = tiles, .threshold = rule, .tolerance = 0.01, .bounds = bounds}),
          lossy));
    }
  }
}

/// Returns the largest ratio of alpha to Th among the pairs that a tolerance leaves out. The lists use Th
/// times `injected`.
double largest_left_out(Threshold rule, double tolerance, double fault_factor) {
  const shared::View view = view_of(75, 53);
  std::vector<Splat> splats = random_splats(6, 500, 75, 53);
  const std::vector<std::uint32_t> order = depth_order(splats);
  std::vector<Splat> rated = splats;
  set_thresholds(rated, rule, tolerance);
  std::vector<Splat> listed = rated;
  for (Splat& splat : listed) {
    splat.threshold *= fault_factor;
    splat.drawn = splat.threshold <= splat.opacity;
  }
  const TileLists lists = make_lists(listed, order, view, TILES_ELLIPSE);
  double largest = 0.0;
  for (int y = 0; y < 53; ++y) {
    for (int x = 0; x < 75; ++x) {
      const auto list = lists.at_pixel(x, y);
      const std::vector<std::uint32_t> in_list(list.begin(), list.end());
      for (const std::uint32_t i : order) {
        if (std::find(in_list.begin(), in_list.end(), i) != in_list.end()) continue;
        const glm::dvec2 d = glm::dvec2(x, y) - splats[i].mean;
        const glm::dvec3 c = splats[i].conic;
        const double q = c.x * d.x * d.x + 2 * c.y * d.x * d.y + c.z * d.y * d.y;
        largest = std::max(largest, splats[i].opacity * std::exp(-q / 2) / rated[i].threshold);
      }
    }
  }
  return largest;
}

TEST(Threshold, KeepsPixelsReachingTh) {
  for (const auto& [rule, tolerance] :
       {std::pair(Threshold::exact, 0.0), {Threshold::adagscale, 8.0}, {Threshold::squared, 0.2}}) {
    const double largest = largest_left_out(rule, tolerance, 1.0);
    EXPECT_LT(largest, 1.0);
    EXPECT_GT(largest, 0.97) << "more is kept than need be";
    EXPECT_GT(largest_left_out(rule, tolerance, 1.05), 1.0) << "a threshold that is too large goes unnoticed";
  }
}

TEST(Threshold, BlendKeepsTauAndAlpha) {
  // The splat's only tile remains. Within it, Th changes nothing: alphas blend down to tau.
  const shared::View view = view_of(16, 16);
  std::vector<Splat> splats = {make_splat({8, 8}, {4, 0, 4}, 0.5)};
  const Picture exact = picture_of(splats, view, TILES_ELLIPSE);
  set_thresholds(splats, Threshold::adagscale, 8.0);
  EXPECT_GT(splats[0].threshold, 0.3);
  EXPECT_TRUE(equal_bits(picture_of(splats, view, TILES_ELLIPSE), exact));
}

}  // namespace
}  // namespace binosplat::reference
