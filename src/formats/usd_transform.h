#pragma once
// The transform of an OpenUSD prim: its operations, in their listed order.

#include <glm/glm.hpp>

#include "formats/usda.h"

namespace binosplat {

/// Returns a prim's transform in the scene, given its parent's. Throws Error naming the line for operations
/// that are missing, unknown, or only present as time samples.
glm::dmat4 usd_transform(const UsdaPrim& prim, const glm::dmat4& parent);

}  // namespace binosplat
