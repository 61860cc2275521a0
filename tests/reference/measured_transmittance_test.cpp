#include "reference/adagscale_transmittance.h"

#include <gtest/gtest.h>

#include "reference/splats.h"

namespace binosplat::reference {
namespace {

Splat coloured(double depth, double opacity, const glm::dvec3& colour, double variance = 4.0,
               const glm::dvec2& mean = {8, 8}) {
  Splat splat = make_splat(mean, {variance, 0, variance}, opacity);
  splat.depth = splat.order = depth;
  splat.colour = colour;
  return splat;
}

std::vector<double> measure(const std::vector<Splat>& splats, int size = 16) {
  const shared::View view = view_of(size, size);
  return measure_transmittance(splats, make_lists(splats, depth_order(splats), view, TILES_ELLIPSE), view);
}

/// Variance of a wall, which has the same alpha everywhere.
constexpr double wall = 1e12;

TEST(Transmittance, LayersMatchHandCalculation) {
  const std::vector<Splat> splats = {coloured(3, 0.5, {0.0, 1.0, 0.5}, wall),
                                     coloured(1, 0.6, {1.0, 0.0, 0.0}, wall),
                                     coloured(2, 0.5, {0.5, 0.5, 0.5}, wall)};
  // T: 1, 0.4, 0.2, 0.1.
  const std::vector<double> got = measure(splats);
  EXPECT_NEAR(got[0], 0.2, 1e-6);
  EXPECT_NEAR(got[1], 1.0, 1e-6);
  EXPECT_NEAR(got[2], 0.4, 1e-6);
}

TEST(Transmittance, WeightsMatchHandCalculation) {
  const std::vector<Splat> splats = {coloured(3, 0.5, {0.0, 1.0, 0.5}, wall),
                                     coloured(1, 0.6, {1.0, 0.0, 0.0}, wall),
                                     coloured(2, 0.003, {0.5, 0.5, 0.5}, wall)};  // below tau
  for (const int size : {16, 40}) {                                               // one tile, and nine
    const shared::View view = view_of(size, size);
    const std::vector<double> got =
        measure_weights(splats, make_lists(splats, depth_order(splats), view, TILES_ELLIPSE), view);
    EXPECT_NEAR(got[0], 0.5 * 0.4 * size * size, 1e-3);
    EXPECT_NEAR(got[1], 0.6 * size * size, 1e-3);
    EXPECT_EQ(got[2], 0.0);
  }
}

TEST(Transmittance, IsLargestOverBlendedPixels) {
  // A wall of alpha 0.9 covers the left side. The small splat behind it extends beyond the wall's edge by a
  // pixel or two.
  const std::vector<Splat> splats = {make_splat({0, 8}, {4, 0, 1e9}, 0.9), coloured(2, 0.5, glm::dvec3(1))};
  const std::vector<double> got = measure(splats);
  EXPECT_EQ(got[0], 1.0);
  EXPECT_EQ(got[1], 1.0);
  std::vector<Splat> hidden = splats;
  hidden[0].covariance = {1e9, 0, 1e9};
  hidden[0].conic = {1e-9, 0, 1e-9};
  hidden[0].det = 1e18;
  EXPECT_NEAR(measure(hidden)[1], 0.1, 1e-5);
}

TEST(Transmittance, DistinguishesHiddenFromUnseen) {
  std::vector<Splat> splats;
  for (int i = 0; i < 3; ++i) splats.push_back(coloured(1 + i, 0.99, glm::dvec3(1), wall));
  splats.push_back(coloured(9, 0.5, glm::dvec3(1)));                                      // behind these
  splats.push_back(coloured(0.5, 0.5, glm::dvec3(1), 4, {-40, 8}));                       // outside
  splats.push_back(coloured(0.5, 0.003, glm::dvec3(1)));                                  // below tau
  splats.push_back(coloured(0.5, ALPHA_MIN * 1.0001, glm::dvec3(1), 4, {8.001, 8.001}));  // in one pixel only
  splats.push_back(coloured(0.5, 0.5, glm::dvec3(1)));                                    // removed by Th
  splats.push_back(coloured(0.5, 0.5, glm::dvec3(1)));
  splats[7].threshold = 0.6;
  splats[8].drawn = false;
  const std::vector<double> got = measure(splats);
  EXPECT_EQ(got[0], 1.0);
  EXPECT_NEAR(got[1], 0.01, 1e-9);
  EXPECT_EQ(got[2], 0.0) << "would leave 1e-6: the pixels stop before it";
  EXPECT_EQ(got[3], 0.0);
  EXPECT_EQ(got[4], not_seen);
  EXPECT_EQ(got[5], not_seen);
  EXPECT_EQ(got[6], 1.0);
  EXPECT_EQ(got[7], not_seen);
  EXPECT_EQ(got[8], not_seen);
  EXPECT_EQ(floored({1.0, 0.5, 0.003, 0.0, not_seen}, 0.01),
            (std::vector<double>{1.0, 0.5, 0.01, 0.01, 1.0}));
}

/// Returns splats so faint that no pixel stops early.
std::vector<Splat> faint_splats() {
  std::vector<Splat> splats = random_splats(9, 60, 48, 48);
  for (Splat& splat : splats) splat.opacity = 0.02 + 0.28 * splat.opacity;
  return splats;
}

/// Returns max(T), computed pixel by pixel from its definition: the product of 1 - alpha of all nearer splats
/// that reach tau.
std::vector<double> transmittance_by_products(const std::vector<Splat>& splats) {
  const auto alpha_at = [](const Splat& s, int x, int y) {
    const glm::dvec2 d = glm::dvec2(x, y) - s.mean;
    const double q = s.conic.x * d.x * d.x + 2 * s.conic.y * d.x * d.y + s.conic.z * d.y * d.y;
    const double alpha = std::min(0.99, s.opacity * std::exp(-q / 2));
    return alpha < 1.0 / 255 ? 0.0 : alpha;
  };
  std::vector<double> result(splats.size(), 0.0);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 48; ++x) {
      for (std::size_t i = 0; i < splats.size(); ++i) {
        if (alpha_at(splats[i], x, y) == 0.0) continue;
        double t = 1.0;
        for (const Splat& nearer : splats) {
          if (nearer.depth < splats[i].depth) t *= 1 - alpha_at(nearer, x, y);
        }
        result[i] = std::max(result[i], t);
      }
    }
  }
  return result;
}

TEST(Transmittance, MatchesProductOfNearerSplats) {
  const std::vector<Splat> splats = faint_splats();
  const std::vector<double> wanted = transmittance_by_products(splats), got = measure(splats, 48);
  std::vector<Splat> farther = splats;
  for (Splat& splat : farther) splat.order = 10 - splat.order;
  const std::vector<double> reversed = measure(farther, 48);
  int wrong_order = 0;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    EXPECT_NEAR(std::max(0.0, got[i]), wanted[i], 1e-12) << i;
    if (std::abs(std::max(0.0, reversed[i]) - wanted[i]) > 1e-3) ++wrong_order;
  }
  EXPECT_GT(wrong_order, 10) << "the wrong order goes unnoticed";
}

TEST(Transmittance, DoesNotDependOnTileTest) {
  const std::vector<Splat> splats = random_splats(10, 400, 75, 53);
  const shared::View view = view_of(75, 53);
  const std::vector<std::uint32_t> order = depth_order(splats);
  const auto with = [&](int tiles) {
    return measure_transmittance(splats, make_lists(splats, order, view, tiles), view);
  };
  const std::vector<double> expected = with(TILES_ELLIPSE);
  EXPECT_EQ(with(TILES_ELLIPSE), expected) << "two runs differ";
  const std::vector<double> all = with(TILES_ALL);
  for (std::size_t i = 0; i < splats.size(); ++i) EXPECT_EQ(std::max(0.0, expected[i]), all[i]);
}

}  // namespace
}  // namespace binosplat::reference
