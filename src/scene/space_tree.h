#pragma once
// A model split in two again and again, so that neighbours in space are neighbours in memory.

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace binosplat {

/// Positions `first` to `first + count` - 1 of an order.
struct SpaceNode {
  std::size_t first = 0, count = 0;
  std::vector<SpaceNode> children;  // two, or none of a leaf
};

struct SpaceTree {
  std::vector<std::uint32_t> order;  // indices
  SpaceNode root;
};

/// Splits the box around the positions in halves across its longest side, so that what lies far out is by
/// itself, and those at one place by their indices, until no leaf has more than `most`. The order of what is
/// not split stays. Beyond 64 splits on end, which takes outliers without end, it splits at the median.
SpaceTree make_space_tree(std::span<const glm::vec3> positions, std::size_t most);

}  // namespace binosplat
