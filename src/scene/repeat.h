#pragma once
// Larger models for benchmarks: copies of a model side by side.

#include <span>

#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat {

/// Returns nx * nz copies of the model, moved by (i * spacing, 0, j * spacing) in world units. i takes nx
/// values from -floor((nx - 1) / 2) upwards (-3..4 for 8, -1..2 for 4, 0..1 for 2), and j takes nz values in
/// the same way. Copies follow one another in memory, j fastest. left_out stays that of one copy. Throws
/// Error, naming the option, for counts below 1, a spacing that is not finite, or over 2^31 Gaussians.
Model repeat(Model model, int nx, int nz, double spacing, std::span<const Camera> cameras = {});

/// Moves the origin of models or copies, of which the farthest is `radii` of its core's radii from there, to
/// the first camera if floats round it visibly. Warns if others are rounded then. Returns the move.
glm::dvec3 move_near(std::span<const Camera> cameras, double radii, ModelAxes& axes);

}  // namespace binosplat
