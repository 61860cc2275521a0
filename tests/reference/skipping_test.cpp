#include "reference/adagscale_contributions.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

#include "reference/adagscale_transmittance.h"
#include "reference/splats.h"

namespace binosplat::reference {
namespace {

constexpr std::array opacities = {0.3, 0.9, 0.2, 0.8};
constexpr std::array lights = {1.0, 0.7, 0.07, 0.056};  // T in front of each wall
const std::array<glm::dvec3, 4> colours = {glm::dvec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}};

/// Returns four walls, one behind the other, each with the same alpha everywhere.
std::vector<Splat> walls() {
  std::vector<Splat> splats;
  for (std::size_t i = 0; i < 4; ++i) {
    splats.push_back(make_splat({8, 8}, {1e12, 0, 1e12}, opacities[i]));
    splats.back().depth = splats.back().order = 1.0 + static_cast<double>(i);
    splats.back().colour = colours[i];
  }
  return splats;
}

glm::dvec3 blended(std::initializer_list<std::size_t> kept) {
  glm::dvec3 sum(0.0);
  double t = 1.0;
  for (const std::size_t i : kept) {
    sum += t * opacities[i] * colours[i];
    t *= 1.0 - opacities[i];
  }
  return sum;
}

struct Skipping : testing::Test {
  shared::View view = view_of(20, 18);
  std::vector<Splat> splats = walls();
  TileLists lists = make_lists(splats, depth_order(splats), view, TILES_ELLIPSE);

  void expect(std::span<const double> bounds, double share, double skipped, const glm::dvec3& colour) {
    const auto results = skip_lowest(splats, lists, view, bounds, std::array{share});
    ASSERT_EQ(results.size(), 1u);
    EXPECT_DOUBLE_EQ(results[0].share, skipped);
    for (const glm::vec4& pixel : results[0].picture.colour)
      EXPECT_NEAR(glm::distance(glm::dvec3(pixel), colour), 0.0, 1e-6);
  }
};

TEST_F(Skipping, SkipsLowestContributions) {
  // alpha T: 0.3, 0.63, 0.014, 0.0448.
  expect({}, 0.0, 0.0, blended({0, 1, 2, 3}));
  expect({}, 0.25, 0.25, blended({0, 1, 3}));
  expect({}, 0.5, 0.5, blended({0, 1}));
  expect({}, 0.74, 0.5, blended({0, 1}));
  expect({}, 0.75, 0.75, blended({1}));
  expect({}, 1.0, 1.0, blended({}));
  // By alpha alone, the first wall is skipped before the last, which is hidden.
  const std::vector<double> ones(4, 1.0);
  expect(ones, 0.5, 0.5, blended({1, 3}));
  expect(lights, 0.5, 0.5, blended({0, 1}));
  // Bounds in which the last wall is not hidden.
  expect(std::array{1.0, 1.0, 0.1, 1.0}, 0.5, 0.5, blended({1, 3}));
}

// Of eight entries of a list that a pixel evaluates, four are below tau there. So half of the entries cost
// nothing, and three quarters cost as much as half of the blended ones.
TEST_F(Skipping, CountsUnblendedEvaluations) {
  for (int k = 0; k < 4; ++k) {
    splats.push_back(splats.front());
    splats.back().opacity = 0.9 * ALPHA_MIN;
  }
  const std::vector<std::uint32_t> all = {0, 4, 5, 1, 6, 2, 7, 3};
  for (std::uint32_t t = 0; t < 4; ++t) lists.begin[t + 1] = 8 * (t + 1);
  lists.gaussians.clear();
  for (int t = 0; t < 4; ++t) lists.gaussians.insert(lists.gaussians.end(), all.begin(), all.end());
  const auto colour = [&](double share) {
    const auto results = skip_lowest(splats, lists, view, {}, std::array{share}, Counted::evaluated);
    EXPECT_DOUBLE_EQ(results[0].share, share);
    return glm::dvec3(results[0].picture.colour.front());
  };
  EXPECT_NEAR(glm::distance(colour(0.5), blended({0, 1, 2, 3})), 0.0, 1e-6);
  EXPECT_NEAR(glm::distance(colour(0.75), blended({0, 1})), 0.0, 1e-6);
  expect({}, 0.5, 0.5, blended({0, 1}));  // of the blended ones
}

TEST_F(Skipping, LightMatchesWalls) {
  const auto light = measure_transmittance(splats, lists, view);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(light[i], lights[i], 1e-9);
}

// The contribution of one spot falls as sigma exp(-d^2 / (2 v)) with the distance of d px. That of an equally
// wide spot behind it is multiplied by T. Bins by depth instead of distance would put all of a spot into one
// bin.
TEST(Contributions, FallWithPixelDistance) {
  const shared::View view = view_of(64, 48);
  constexpr double variance = 16.0;
  std::vector<Splat> splats = {make_splat({30, 20}, {variance, 0, variance}, 0.8),
                               make_splat({30, 20}, {variance, 0, variance}, 0.5)};
  splats[0].depth = splats[0].order = 1.0;
  splats[1].depth = splats[1].order = 2.0;
  const TileLists lists = make_lists(splats, depth_order(splats), view, TILES_ELLIPSE);
  std::map<double, std::pair<double, std::uint64_t>> wanted;  // by the end of the bin
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      const double d = std::hypot(x - 30, y - 20), fall = std::exp(-0.5 * d * d / variance);
      const double end = d < 1.0 ? 1.0 : std::exp2(0.5 * (std::floor(2.0 * std::log2(d)) + 1.0));
      double t = 1.0;
      for (const double sigma : {0.8, 0.5}) {
        const double alpha = sigma * fall;
        if (alpha < ALPHA_MIN) continue;
        auto& [sum, fragments] = wanted[end];
        sum += alpha * t;
        ++fragments;
        t *= 1.0 - alpha;
      }
    }
  }
  double last = 1.0;
  std::size_t filled = 0;
  for (const DistanceBin& bin : contributions_by_distance(splats, lists, view)) {
    if (bin.fragments == 0) continue;
    const auto& [sum, fragments] = wanted.at(bin.to);
    EXPECT_EQ(bin.fragments, fragments) << bin.to;
    EXPECT_NEAR(bin.sum, sum, 1e-6) << bin.to;
    EXPECT_LE(bin.largest, last) << "nearer ones contribute more";
    last = bin.largest;
    ++filled;
  }
  EXPECT_EQ(filled, wanted.size());
  EXPECT_LT(last, 0.02);
}

TEST(SkippingRandomSplats, BetterBoundsCostLess) {
  std::vector<Splat> splats = random_splats(5, 300, 64, 48);
  const shared::View view = view_of(64, 48);
  const TileLists lists = make_lists(splats, depth_order(splats), view, TILES_ELLIPSE);
  const Picture exact = blend(splats, lists, view);
  const auto light = measure_transmittance(splats, lists, view);
  const std::vector<double> ones(splats.size(), 1.0);
  const auto error = [&](std::span<const double> bounds) {
    const auto results = skip_lowest(splats, lists, view, bounds, std::array{0.0, 0.5});
    EXPECT_TRUE(equal_bits(results[0].picture, exact)) << "nothing skipped";
    EXPECT_NEAR(results[1].share, 0.5, 0.02);
    double sum = 0.0;
    for (std::size_t k = 0; k < exact.colour.size(); ++k) {
      const glm::dvec3 d = glm::dvec3(results[1].picture.colour[k]) - glm::dvec3(exact.colour[k]);
      sum += glm::dot(d, d);
    }
    return sum;
  };
  const double by_truth = error({}), by_light = error(light), by_alpha = error(ones);
  EXPECT_LT(by_truth, by_light);
  EXPECT_LT(by_light, by_alpha);
}

}  // namespace
}  // namespace binosplat::reference
