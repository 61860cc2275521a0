#pragma once
// Eyes as OpenXR gives them, and where their space lies in the model's world.
//
// Two spaces. The eyes' space is OpenXR's, in metres: x right, y up, z backward. The model's world has the
// axes and units of the model's file. A Placement leads from the first to the second.

#include <glm/glm.hpp>

namespace binosplat {

// The library is compiled with GLM's types as they come. A program that has them aligned
// (GLM_FORCE_DEFAULT_ALIGNED_GENTYPES) would see other structs than the library does.
static_assert(sizeof(glm::vec3) == 3 * sizeof(float) && sizeof(glm::dvec3) == 3 * sizeof(double),
              "binosplat needs GLM without GLM_FORCE_DEFAULT_ALIGNED_GENTYPES");

/// World units in front of an eye within which nothing is drawn, unless something else is asked for: what
/// 3D Gaussian Splatting is trained with, for worlds that are measured in metres or so.
constexpr double near_default = 0.2;

/// A frustum by the angles of its four sides from the forward axis, in radians, in the order of XrFovf: left
/// and down are negative where the axis lies inside. It may be asymmetric, as those of headsets are. Each
/// angle is less than a quarter turn, left is below right and down below up.
struct Fov {
  double left = 0;
  double right = 0;
  double up = 0;
  double down = 0;
};

/// One eye, as XrView has it. Eyes may be canted, which is to say turned away from each other.
struct Eye {
  glm::dvec3 position{0.0};                    // m, in the eyes' space
  glm::dvec4 orientation{0.0, 0.0, 0.0, 1.0};  // quaternion x, y, z, w, as XrQuaternionf; of any length but 0
  Fov fov = {};
};

/// Where the eyes' space lies in the model's world: a point p of it, in metres, lies at
/// origin + units_per_metre * axes * p. SplatModel::placement() makes one that stands upright.
struct Placement {
  glm::dvec3 origin{0.0};  // world units
  /// The directions right, up and backward in the world, as columns of length 1 at right angles. By default
  /// they are those of most trained models, whose y axis points down and z forward.
  glm::dmat3 axes{1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0};
  /// World units that make a metre, above 0. Trained models have any scale: where this number is too small
  /// the world looks too large. The library never changes it by itself.
  double units_per_metre = 1.0;
};

}  // namespace binosplat
