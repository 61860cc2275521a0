#pragma once
// Which way a model's axes point.
//
// Cameras live in a world as COLMAP leaves it: x right, y down, z forward ("RDF" in the letters below). Most
// models are trained in it; some formats store another frame. A model keeps the numbers of its file, so that
// no spherical harmonics have to be turned, and cameras are brought into its frame instead. So they are, too,
// into that of a model far away from zero, whose positions are relative to an origin beside it.

#include <glm/glm.hpp>
#include <string_view>

#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat {

/// The directions of a frame's x, y and z by three letters: R or L (right, left), U or D (up, down), F or B
/// (forward, back), each pair once, as in "RUB" (OpenGL, spz) and "LUF" (glTF). Returns the signed
/// permutation whose columns are x, y and z in the world; frames that mirror are allowed. Throws Error.
glm::dmat3 world_from_axes(std::string_view letters);

/// A point of a model's frame, from its origin, in the world, and back.
glm::dvec3 into_world(const glm::dvec3& point, const ModelAxes& axes);
glm::dvec3 into_axes(const glm::dvec3& point, const ModelAxes& axes);

/// Changes a model's numbers to those of the frame `letters`, where it looks the same from every camera of
/// the world; mirrored frames, too. Not for models with a scaffold.
void bring_into_axes(Model& model, std::string_view letters);

/// A camera of the world as seen in a model's frame: it sees the model as the camera sees the world.
Camera into_axes(Camera camera, const ModelAxes& axes);

}  // namespace binosplat
