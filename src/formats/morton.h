#pragma once
// An order by which neighbours in space are mostly neighbours in the file.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace binosplat {

/// Returns the indices of the positions along a Morton curve (1966) of 2^21 steps an axis over their bounding
/// box; those in one cell keep their order.
std::vector<std::uint32_t> morton_order(std::span<const glm::vec3> positions);

}  // namespace binosplat
