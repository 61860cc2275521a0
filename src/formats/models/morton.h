#pragma once
// An order by which neighbours in space are mostly neighbours in the file.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace binosplat {

/// Returns the indices of the positions in the order of a Morton curve (1966). The curve's grid has 2^21
/// cells along each axis of the positions' bounding box. Positions in one cell keep their order.
std::vector<std::uint32_t> morton_order(std::span<const glm::vec3> positions);

}  // namespace binosplat
