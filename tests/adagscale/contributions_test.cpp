// The contributions of Gaussians, in walls with known numbers.

#include "adagscale/contributions.h"

#include <gtest/gtest.h>

#include <cmath>

#include "measure/metrics.h"
#include "support/models.h"

namespace binosplat::adagscale {
namespace {

double number(const Row& row, const char* column) { return row.at(column).get<double>(); }

void expect_near(double got, double wanted, const std::string& what) {
  EXPECT_NEAR(got, wanted, 0.01 * std::abs(wanted)) << what;
}

/// Walls with the same alpha everywhere, at depths 1 to 4.
constexpr double wall_alpha[] = {0.3, 0.9, 0.2, 0.8};
constexpr double wall_light[] = {1.0, 0.7, 0.07, 0.056};

std::vector<Row> of_walls(const std::string& of) {
  Model model;
  for (int i = 0; i < 4; ++i)
    test::add(model, {0, 0, 1 + i}, glm::vec3(1e4f, 1e4f, 1e-3f), static_cast<float>(wall_alpha[i]));
  const CalibrationView view{test::front_camera(32, 24, 32.0)};
  const DepthTable table{5.0f, {1.0f, 1.0f, 1.0f, 0.1f, 1.0f}};
  std::vector<Row> found = contributions(model, std::span(&view, 1), near_default, table, table);
  std::erase_if(found, [&](const Row& row) { return row["kind"] != of; });
  return found;
}

TEST(Contributions, ByDepthMatchWalls) {
  std::size_t walls = 0;
  for (const Row& bin : of_walls("depth")) {
    if (number(bin, "gaussians") == 0) {
      EXPECT_FALSE(bin.contains("largest"));
      continue;
    }
    ASSERT_EQ(number(bin, "gaussians"), 1);
    for (const char* which : {"median", "p90", "largest"})
      expect_near(number(bin, which), wall_light[walls], "transmittance");
    ++walls;
  }
  EXPECT_EQ(walls, 4u);
}

TEST(Contributions, ByDistanceSumToAll) {
  const std::vector<Row> bins = of_walls("distance");
  ASSERT_GT(bins.size(), 3u);
  expect_near(number(bins.back(), "nearer"), 100.0, "of all");
  for (const Row& bin : bins) EXPECT_FALSE(number(bin, "mean") > number(bin, "largest")) << bin;
  expect_near(number(bins.back(), "largest"), 0.63, "the second wall shows most");
}

TEST(Contributions, SkippingCostMatchesContribution) {
  // White walls over black: the picture is 1 - T. By alpha T, the third wall is skipped first, then the last
  // and the first. By alpha, it is the third, the first, the last.
  const std::vector<Row> found = of_walls("skipping");
  const auto rest = [](std::initializer_list<int> kept) {
    double t = 1.0;
    for (const int i : kept) t *= 1.0 - wall_alpha[i];
    return t;
  };
  const auto db = [&](double t) { return -20.0 * std::log10(t - rest({0, 1, 2, 3})); };
  const struct {
    std::size_t curve;
    double quarter, half, most;
  } wanted[] = {{0, db(rest({0, 1, 3})), db(rest({0, 1})), db(rest({1}))},
                {1, db(rest({0, 1, 3})), db(rest({0, 1})), db(rest({1}))},
                {2, db(rest({0, 1, 3})), db(rest({1, 3})), db(rest({1}))},
                {3, db(rest({0, 1, 3})), db(rest({1, 3})), db(rest({1}))},
                {4, db(rest({0, 1, 3})), db(rest({0, 1})), db(rest({1}))}};
  ASSERT_EQ(found.size(), 5u * 9);
  for (const auto& w : wanted) {
    const Row* const points = &found[9 * w.curve];
    const std::string by = points[0]["formula"];
    expect_near(number(points[2], "skipped"), 25.0, by);  // of a share of up to 30 %
    expect_near(number(points[2], "psnr_db"), w.quarter, by + ", one");
    expect_near(number(points[4], "psnr_db"), w.half, by + ", two");
    expect_near(number(points[7], "psnr_db"), w.most, by + ", three");
    EXPECT_EQ(number(points[0], "psnr_db"), measure::equal_db) << by << ": nothing is skipped yet";
  }
  EXPECT_GT(std::abs(db(rest({0, 1})) - db(rest({1, 3}))), 1.0) << "the rules could be mistaken";
}

}  // namespace
}  // namespace binosplat::adagscale
