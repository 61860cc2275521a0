#pragma once
// Checks that every reader of cameras makes.

#include <string>

#include "scene/camera.h"

namespace binosplat {

/// Throws Error beginning with `where` for pictures without pixels or with more than 2^31, and for invalid
/// focal lengths and principal points.
void check_lens(const std::string& where, const Camera& camera);

/// Returns why columns are no camera axes (x right, y down, z forward): not orthogonal or not of length 1
/// within 1e-3, or mirrored. Returns "" if they are.
std::string rotation_fault(const glm::dmat3& columns);

}  // namespace binosplat
