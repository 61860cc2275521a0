#pragma once
// Where an OpenUSD prim is: its transform operations, in the order that it names.

#include <glm/glm.hpp>

#include "formats/usda.h"

namespace binosplat {

/// A prim's place in the scene, of that of the prim above it. Throws Error naming the line for operations
/// that are not there, not known, or only there at points in time.
glm::dmat4 usd_transform(const UsdaPrim& prim, const glm::dmat4& parent);

}  // namespace binosplat
