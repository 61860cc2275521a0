#pragma once
// Checks that every reader of cameras applies.

#include <string>

#include "scene/camera.h"

namespace binosplat {

/// Throws Error for pictures without pixels or with more than 2^31 px, and for invalid focal lengths and
/// principal points. The text begins with `where`.
void check_lens(const std::string& where, const Camera& camera);

/// Returns why the columns are no camera axes (x right, y down, z forward): they are not orthonormal within
/// 1e-3, or they include a reflection. Returns "" if they are camera axes.
std::string rotation_fault(const glm::dmat3& columns);

/// Replaces camera axes of a file by the nearest rotation, because files round them, and Blender scales them.
/// Warns, naming `source`, if they are off by more than 1 %. Returns rotation_fault() if they mirror, are
/// sheared by more than 10 %, or one is twice as long as another.
std::string make_rotation(const std::string& source, glm::dmat3& columns);

}  // namespace binosplat
