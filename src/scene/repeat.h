#pragma once
// Larger models for benchmarks: copies of a model side by side.

#include "scene/model.h"

namespace binosplat {

/// Returns nx * nz copies of the model, moved by (i * spacing, 0, j * spacing) in world units. i takes nx
/// values from -floor((nx - 1) / 2) upwards (-3..4 for 8, -1..2 for 4, 0..1 for 2), and j takes nz values in
/// the same way. Copies follow one another in memory, j fastest. left_out stays that of one copy. Throws
/// Error, naming the option, for counts below 1, a spacing that is not finite, or over 2^31 Gaussians.
Model repeat(Model model, int nx, int nz, double spacing);

}  // namespace binosplat
