#pragma once
// Larger models for measuring: copies of one, side by side.

#include "scene/model.h"

namespace binosplat {

/// nx * nz copies of the model, moved by (i * spacing, 0, j * spacing) in world units: i runs over nx numbers
/// from -floor((nx - 1) / 2) upwards (-3..4 for 8, -1..2 for 4, 0..1 for 2) and j over nz numbers likewise.
/// Copies follow one another in memory, j fastest. left_out stays what it was for one. Throws Error, naming
/// --repeat or --spacing, for numbers below 1, a spacing that is not finite, or more than 2^31 Gaussians.
Model repeat(Model model, int nx, int nz, double spacing);

}  // namespace binosplat
