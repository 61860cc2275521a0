#pragma once
// What every reader of cameras asks of them.

#include <string>

#include "scene/camera.h"

namespace binosplat {

/// Throws Error beginning with `where` for pictures without pixels or with more than 2^31, and for focal
/// lengths and principal points that are none.
void check_lens(const std::string& where, const Camera& camera);

/// What is wrong with columns that should be the axes of a camera, x right, y down, z forward: not orthogonal
/// or not of length 1 within 1e-3, or mirrored. "" if nothing is.
std::string rotation_fault(const glm::dmat3& columns);

}  // namespace binosplat
