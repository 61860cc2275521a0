#include "scene/space_partition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>

#include "support/models.h"

namespace binosplat {
namespace {

std::vector<glm::vec3> places(std::uint32_t seed, std::size_t count) {
  test::Uniform uniform(seed);
  std::vector<glm::vec3> result(count);
  for (glm::vec3& p : result) p = {uniform(0, 8), uniform(0, 2), uniform(0, 1)};
  return result;
}

/// Checks that a node's children split it at the middle of the longest side of its bounding box, and
/// recursively.
void check(const SpaceTree& tree, const SpaceNode& node, const std::vector<glm::vec3>& at, std::size_t most) {
  const auto box = [&](const SpaceNode& part) {
    std::pair<glm::vec3, glm::vec3> b(glm::vec3(1e38f), glm::vec3(-1e38f));
    for (std::size_t k = part.first; k < part.first + part.count; ++k) {
      b.first = glm::min(b.first, at[tree.order[k]]);
      b.second = glm::max(b.second, at[tree.order[k]]);
    }
    return b;
  };
  if (node.children.empty()) {
    EXPECT_LE(node.count, most);
    return;
  }
  EXPECT_GT(node.count, most);
  ASSERT_EQ(node.children.size(), 2u);
  const SpaceNode &a = node.children[0], &b = node.children[1];
  EXPECT_EQ(a.first, node.first);
  EXPECT_EQ(b.first, a.first + a.count);
  EXPECT_EQ(a.count + b.count, node.count);
  const auto [low, high] = box(node);
  const glm::dvec3 side = glm::dvec3(high) - glm::dvec3(low);
  const double longest = std::max({side.x, side.y, side.z});
  int across = 0;
  for (int k = 0; k < 3; ++k) {
    const double middle = 0.5 * (double{low[k]} + double{high[k]});
    across += side[k] == longest && box(a).second[k] < middle && box(b).first[k] >= middle;
  }
  EXPECT_TRUE(across == 1 || longest == 0.0);
  for (const SpaceNode& child : node.children) check(tree, child, at, most);
}

TEST(SpaceTree, SplitsLongestSide) {
  for (const std::size_t count : {1, 7, 64, 1000, 1001}) {
    const std::vector<glm::vec3> at = places(3, count);
    const SpaceTree tree = make_space_tree(at, 10);
    EXPECT_EQ(tree.root.count, count);
    check(tree, tree.root, at, 10);
    std::vector<std::uint32_t> sorted = tree.order, all(count);
    std::iota(all.begin(), all.end(), 0u);
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, all);
  }
}

TEST(SpaceTree, SplitsCoincidentPoints) {
  const SpaceTree tree = make_space_tree(std::vector<glm::vec3>(100, glm::vec3(4)), 10);
  check(tree, tree.root, std::vector<glm::vec3>(100, glm::vec3(4)), 10);
  for (std::size_t k = 0; k < 50; ++k) EXPECT_LT(tree.order[k], 50u) << "by their indices";
}

TEST(SpaceTree, SeparatesOutliers) {
  std::vector<glm::vec3> at = places(4, 300'000);
  for (std::size_t i = 0; i < at.size(); i += 10'000) at[i] = at[i] * 1e30f + 1e3f;
  const SpaceTree tree = make_space_tree(at, 2000);
  check(tree, tree.root, at, 2000);
  std::size_t mixed = 0;
  const std::function<void(const SpaceNode&)> walk = [&](const SpaceNode& node) {
    for (const SpaceNode& child : node.children) walk(child);
    std::size_t far = 0;
    for (std::size_t k = node.first; k < node.first + node.count; ++k) far += at[tree.order[k]].x > 100.0f;
    mixed += node.children.empty() && far != 0 && far != node.count;
  };
  walk(tree.root);
  EXPECT_EQ(mixed, 0u);
}

// Each is at a fifth of the distance of the one before. Halved in space, each would need a separate level of
// the tree.
TEST(SpaceTree, DepthIsBoundedForOutliers) {
  std::vector<glm::vec3> at;
  for (int i = 0; i < 3000; ++i) {
    const float far = std::pow(0.2f, static_cast<float>(i % 100)) * 1e30f;
    at.emplace_back(i % 3 == 0 ? far : 0.0f, i % 3 == 1 ? far : 0.0f, i % 3 == 2 ? far : 0.0f);
  }
  const SpaceTree tree = make_space_tree(at, 10);
  const std::function<int(const SpaceNode&)> depth = [&](const SpaceNode& node) {
    EXPECT_TRUE(!node.children.empty() || node.count <= 10);
    int most = 0;
    for (const SpaceNode& child : node.children) most = std::max(most, 1 + depth(child));
    return most;
  };
  EXPECT_GT(depth(tree.root), 60);
  EXPECT_LE(depth(tree.root), 64 + 12);
}

}  // namespace
}  // namespace binosplat
