#include "formats/detail.h"

#include <gtest/gtest.h>

namespace binosplat {
namespace {

// Boxes of 1 along x, each with levels of 400, 100 and 25 Gaussians.
std::vector<DetailPart> row(int count) {
  std::vector<DetailPart> parts;
  for (int i = 0; i < count; ++i)
    parts.push_back({{2.0 * i, 0, 0}, {2.0 * i + 1, 1, 1}, {{0, 400}, {1, 100}, {2, 25}}});
  return parts;
}

std::size_t total(const std::vector<DetailPart>& parts, const std::vector<std::size_t>& chosen) {
  std::size_t sum = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!parts[i].levels.empty()) sum += parts[i].levels[chosen[i]].count;
  }
  return sum;
}

TEST(Detail, WhatIsNearComesFirst) {
  const std::vector<DetailPart> parts = row(6);
  const std::vector<std::size_t> chosen = choose_levels(parts, {{-1, 0.5, 0.5}}, 899);
  EXPECT_EQ(chosen, (std::vector<std::size_t>{0, 1, 1, 1, 1, 2}));
  // From the other end, and with an eye at either end, one choice for both.
  EXPECT_EQ(choose_levels(parts, {{12, 0.5, 0.5}}, 899), (std::vector<std::size_t>{2, 1, 1, 1, 1, 0}));
  EXPECT_EQ(choose_levels(parts, {{-1, 0.5, 0.5}, {12, 0.5, 0.5}}, 1250),
            (std::vector<std::size_t>{0, 1, 1, 1, 1, 0}));
}

TEST(Detail, KeepsToTheBudget) {
  const std::vector<DetailPart> parts = row(6);
  for (std::size_t most = 150; most < 2500; most += 25) {
    const std::size_t used = total(parts, choose_levels(parts, {}, most));
    EXPECT_LE(used, most);
    EXPECT_GE(used + 300, std::min<std::size_t>(most, 2400)) << "room for one more step is left";
  }
  EXPECT_EQ(choose_levels(parts, {}, 2400), std::vector<std::size_t>(6, 0));
  EXPECT_EQ(choose_levels(parts, {}, 0), std::vector<std::size_t>(6, 2)) << "the coarsest are there anyway";
}

TEST(Detail, PartsThatLackLevels) {
  std::vector<DetailPart> parts = row(3);
  parts[0].levels.clear();
  parts[1].levels = {{1, 100}};
  const std::vector<std::size_t> chosen = choose_levels(parts, {{0.5, 0.5, 0.5}}, 10000);
  EXPECT_EQ(chosen[1], 0u);
  EXPECT_EQ(total(parts, chosen), 500u);
  EXPECT_TRUE(choose_levels({}, {}, 10).empty());
}

}  // namespace
}  // namespace binosplat
