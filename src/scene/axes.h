#pragma once
// The axes of a model's coordinate frame, and conversions between this frame and the world.
//
// The cameras' world is COLMAP's: x right, y down, z forward ("RDF" in the letters below). Most models are
// trained in it; some formats store another frame. A model keeps the numbers of its file, so that no
// spherical harmonics are rotated, and cameras are brought into the model's frame instead. If a model lies
// far from zero, its positions are relative to an origin near it, and so are its cameras' positions.

#include <glm/glm.hpp>
#include <string_view>

#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat {

/// Parses the directions of a frame's x, y and z, in this order. `letters` has one letter of each pair: R or
/// L (right, left), U or D (up, down), F or B (forward, back), as in "RUB" (OpenGL, spz) and "LUF" (glTF).
/// Returns the signed permutation whose columns are x, y and z in the world; it may include a reflection.
/// Throws Error for other letters.
glm::dmat3 world_from_axes(std::string_view letters);

/// Returns the largest absolute element of M^T M - 1, where 1 is the identity: 0 if the columns of M are
/// orthonormal, infinite if a number is not finite.
double orthonormality_error(const glm::dmat3& columns);

/// Convert a point between a model's frame (relative to its origin) and the world.
glm::dvec3 into_world(const glm::dvec3& point, const ModelAxes& axes);
glm::dvec3 into_axes(const glm::dvec3& point, const ModelAxes& axes);

/// Converts a model without scaffold to the frame `letters`, also by reflection. Its pictures stay the same.
void bring_into_axes(Model& model, std::string_view letters);

/// Converts a camera of the world to a model's frame: its picture of the model is the world camera's.
Camera into_axes(Camera camera, const ModelAxes& axes);

}  // namespace binosplat
