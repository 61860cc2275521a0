#include "scene/space_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
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

/// Whether the halves of a node lie on both sides of a plane across the longest side of its box, and are the
/// whole of it; and those of its halves.
void check(const SpaceTree& tree, const SpaceNode& node, const std::vector<glm::vec3>& at, std::size_t most) {
  const auto box = [&](const SpaceNode& part) {
    std::pair<glm::vec3, glm::vec3> b(glm::vec3(1e9f), glm::vec3(-1e9f));
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
  EXPECT_LE(b.count - a.count, 1u);
  const glm::vec3 side = box(node).second - box(node).first;
  for (int k = 0; k < 3; ++k) {
    if (side[k] == std::max({side.x, side.y, side.z})) {
      EXPECT_LE(box(a).second[k], box(b).first[k]);
    }
  }
  for (const SpaceNode& child : node.children) check(tree, child, at, most);
}

TEST(SpaceTree, CutsInHalvesAcrossTheLongestSide) {
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

TEST(SpaceTree, CutsWhatLiesAtOnePlace) {
  const SpaceTree tree = make_space_tree(std::vector<glm::vec3>(100, glm::vec3(4)), 10);
  check(tree, tree.root, std::vector<glm::vec3>(100, glm::vec3(4)), 10);
  for (std::size_t k = 0; k < 50; ++k) EXPECT_LT(tree.order[k], 50u) << "by their indices";
}

}  // namespace
}  // namespace binosplat
