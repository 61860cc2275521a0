#include "stream/choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/details.h"

namespace binosplat {
namespace {

// Boxes of 1 along x, each with levels of 400, 100 and 25 Gaussians.
std::vector<LodChunk> row_of_parts(int count) {
  std::vector<LodChunk> parts;
  for (int i = 0; i < count; ++i)
    parts.push_back({{2.0 * i, 0, 0}, {2.0 * i + 1, 1, 1}, {{0, 400}, {1, 100}, {2, 25}}});
  return parts;
}

TEST(Detail, WhatIsNearComesFirst) {
  const std::vector<LodChunk> parts = row_of_parts(6);
  const std::vector<std::size_t> chosen = choose_levels(parts, {{-1, 0.5, 0.5}}, 899);
  EXPECT_EQ(chosen, (std::vector<std::size_t>{0, 1, 1, 1, 1, 2}));
  // From the other end, and with an eye at either end, one choice for both.
  EXPECT_EQ(choose_levels(parts, {{12, 0.5, 0.5}}, 899), (std::vector<std::size_t>{2, 1, 1, 1, 1, 0}));
  EXPECT_EQ(choose_levels(parts, {{-1, 0.5, 0.5}, {12, 0.5, 0.5}}, 1250),
            (std::vector<std::size_t>{0, 1, 1, 1, 1, 0}));
}

TEST(Detail, KeepsToTheBudget) {
  const std::vector<LodChunk> parts = row_of_parts(6);
  for (std::size_t most = 150; most < 2500; most += 25) {
    const std::size_t used = test::gaussians_of(parts, choose_levels(parts, {}, most));
    EXPECT_LE(used, most);
    EXPECT_GE(used + 300, std::min<std::size_t>(most, 2400)) << "room for one more step is left";
  }
  EXPECT_EQ(choose_levels(parts, {}, 2400), std::vector<std::size_t>(6, 0));
  EXPECT_EQ(choose_levels(parts, {}, 0), std::vector<std::size_t>(6, 2)) << "the coarsest are there anyway";
}

/// Whether each part is as fine as `enough` asks, and no finer.
bool as_needed(const std::vector<LodChunk>& parts, const std::vector<std::size_t>& chosen,
               const glm::dvec3& eye, double enough) {
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const double distance = glm::distance(eye, glm::clamp(eye, parts[p].low, parts[p].high));
    const auto apart = [&](std::size_t level) {
      return std::sqrt(3.0 / static_cast<double>(parts[p].levels[level].count)) / distance;
    };
    if (chosen[p] > 0 && apart(chosen[p]) > enough) return false;
    if (chosen[p] + 1 < parts[p].levels.size() && apart(chosen[p] + 1) <= enough) return false;
  }
  return true;
}

TEST(Detail, FineEnoughIsEnough) {
  const std::vector<LodChunk> parts = row_of_parts(6);
  const glm::dvec3 eye(-1, 0.5, 0.5);
  std::size_t last = 6 * 400 + 1;
  for (const double enough : {0.005, 0.02, 0.04, 0.08, 0.16, 1.0}) {
    const std::vector<std::size_t> chosen = choose_levels(parts, {eye}, 10000, enough);
    EXPECT_TRUE(as_needed(parts, chosen, eye, enough)) << enough;
    EXPECT_LT(test::gaussians_of(parts, chosen), last) << enough;
    last = test::gaussians_of(parts, chosen);
  }
  // Planted faults: what is near as if it were far, and a part that is too fine.
  std::vector<std::size_t> wrong = choose_levels(parts, {eye}, 10000, 0.04);
  std::reverse(wrong.begin(), wrong.end());
  EXPECT_FALSE(as_needed(parts, wrong, eye, 0.04));
  wrong = choose_levels(parts, {eye}, 10000, 0.04);
  --wrong.back();
  EXPECT_FALSE(as_needed(parts, wrong, eye, 0.04));
}

TEST(Detail, KeepsToWhatWasChosenBefore) {
  const std::vector<LodChunk> parts = row_of_parts(6);
  const auto choose = [&](double x, std::span<const std::size_t> before) {
    return choose_levels(parts, {{x, 0.5, 0.5}}, 10000, 0.04, before);
  };
  for (double x = -12.0; x < 0.0; x += 0.25) {
    const std::vector<std::size_t> here = choose(x, {});
    for (const double by : {0.97, 1.03}) {  // of the distance to the nearest part; less to the others
      EXPECT_EQ(choose(x * by, here), here) << x << " times " << by;
    }
  }
  const std::vector<std::size_t> far_away = choose(-12.0, {});
  EXPECT_NE(choose(-1.0, far_away), far_away);
  EXPECT_EQ(choose(-12.0, choose(-1.0, {})), far_away);
}

TEST(Detail, PartsThatLackLevels) {
  std::vector<LodChunk> parts = row_of_parts(3);
  parts[0].levels.clear();
  parts[1].levels = {{1, 100}};
  const std::vector<std::size_t> chosen = choose_levels(parts, {{0.5, 0.5, 0.5}}, 10000);
  EXPECT_EQ(chosen[1], 0u);
  EXPECT_EQ(test::gaussians_of(parts, chosen), 500u);
  EXPECT_TRUE(choose_levels({}, {}, 10).empty());
}

TEST(Detail, LevelsAndFramesShareABudget) {
  const auto error = [](double db) { return std::pow(10.0, -0.1 * db); };
  const double half = levels_share(40.0);
  EXPECT_NEAR(error(half), 0.5e-4, 1e-9);
  EXPECT_NEAR(left_of(40.0, half, half), half, 1e-9);
  EXPECT_NEAR(psnr_of_both(half, left_of(40.0, half, half)), 40.0, 1e-9);
  EXPECT_NEAR(psnr_of_both(46.0, left_of(40.0, half, 46.0)), 40.0, 1e-9) << "what levels do not need";
  EXPECT_NEAR(left_of(40.0, half, 30.0), half, 1e-9) << "finer ones are under way";
  EXPECT_NEAR(left_of(40.0, 40.0, 40.0), 50.0, 1e-9) << "a tenth at least";
  EXPECT_NEAR(left_of(40.0, half, INFINITY), 40.0, 1e-9);
}

}  // namespace
}  // namespace binosplat
