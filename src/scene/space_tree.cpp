#include "scene/space_tree.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace binosplat {

namespace {

glm::length_t longest_side(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices) {
  glm::vec3 low(positions[indices.front()]), high(low);
  for (const std::uint32_t i : indices) {
    low = glm::min(low, positions[i]);
    high = glm::max(high, positions[i]);
  }
  const glm::vec3 side = high - low;
  return side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
}

void cut(SpaceNode& node, std::span<const glm::vec3> positions, std::span<std::uint32_t> order,
         std::size_t most) {
  if (node.count <= most) return;
  const std::span<std::uint32_t> part = order.subspan(node.first, node.count);
  const glm::length_t axis = longest_side(positions, part);
  const auto place = [&](std::uint32_t i) { return std::pair(positions[i][axis], i); };
  const std::size_t half = node.count / 2;
  std::nth_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(half), part.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); });
  node.children = {{node.first, half, {}}, {node.first + half, node.count - half, {}}};
  for (SpaceNode& next : node.children) cut(next, positions, order, most);
}

}  // namespace

SpaceTree make_space_tree(std::span<const glm::vec3> positions, std::size_t most) {
  SpaceTree tree{std::vector<std::uint32_t>(positions.size()), {0, positions.size(), {}}};
  std::iota(tree.order.begin(), tree.order.end(), 0u);
  cut(tree.root, positions, tree.order, most);
  return tree;
}

}  // namespace binosplat
