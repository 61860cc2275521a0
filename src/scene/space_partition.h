#pragma once
// A binary space partition, so that neighbours in space are neighbours in memory.

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace binosplat {

/// Entries `first` to `first + count - 1` of the tree's order.
struct SpaceNode {
  std::size_t first = 0, count = 0;
  std::vector<SpaceNode> children;  // two, or none in a leaf
};

struct SpaceTree {
  std::vector<std::uint32_t> order;  // indices of the positions
  SpaceNode root;
};

/// Halves bounding boxes of positions across their longest side, until each leaf has at most `most`
/// positions. Distant outliers get separate nodes. Equal positions are split by their indices. Nodes deeper
/// than 64 (by ever farther outliers) are split at the median. In other leaves positions keep their order.
SpaceTree make_space_tree(std::span<const glm::vec3> positions, std::size_t most);

}  // namespace binosplat
