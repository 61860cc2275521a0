#include "scene/space_partition.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/parallel.h"

namespace binosplat {

namespace {

/// Deeper nodes are split at the median, which bounds the depth of the tree. lod-meta.json nests as deep as
/// the tree.
constexpr int deepest_middle = 64;

/// Moves the positions in the first half of the longest side to the front, and returns their number.
std::size_t part(std::span<const glm::vec3> positions, std::span<std::uint32_t> chunk, int depth) {
  glm::vec3 low(positions[chunk.front()]), high(low);
  for (const std::uint32_t i : chunk) {
    low = glm::min(low, positions[i]);
    high = glm::max(high, positions[i]);
  }
  const glm::dvec3 side = glm::dvec3(high) - glm::dvec3(low);
  const glm::length_t axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
  const std::size_t half = chunk.size() / 2;
  if (depth > deepest_middle) {
    const auto place = [&](std::uint32_t i) { return std::pair(positions[i][axis], i); };
    std::nth_element(chunk.begin(), chunk.begin() + static_cast<std::ptrdiff_t>(half), chunk.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); });
    return half;
  }
  const double middle = 0.5 * (double{low[axis]} + double{high[axis]});
  const auto beyond = std::stable_partition(chunk.begin(), chunk.end(),
                                            [&](std::uint32_t i) { return positions[i][axis] < middle; });
  const auto first = static_cast<std::size_t>(beyond - chunk.begin());
  return first > 0 ? first : half;  // 0: all positions are equal
}

void split(SpaceNode& node, std::span<const glm::vec3> positions, std::span<std::uint32_t> order,
           std::size_t most, int depth) {
  if (node.count <= most) return;
  const std::size_t first = part(positions, order.subspan(node.first, node.count), depth);
  node.children = {{node.first, first, {}}, {node.first + first, node.count - first, {}}};
  const auto split_child = [&](std::size_t k) { split(node.children[k], positions, order, most, depth + 1); };
  constexpr std::size_t min_per_thread = 1 << 16;
  if (node.count < min_per_thread) {
    for (std::size_t k = 0; k < 2; ++k) split_child(k);
  } else {
    parallel_for(2, split_child);
  }
}

}  // namespace

SpaceTree make_space_tree(std::span<const glm::vec3> positions, std::size_t most) {
  SpaceTree tree{std::vector<std::uint32_t>(positions.size()), {0, positions.size(), {}}};
  std::iota(tree.order.begin(), tree.order.end(), 0u);
  split(tree.root, positions, tree.order, most, 0);
  return tree;
}

}  // namespace binosplat
