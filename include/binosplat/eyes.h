#pragma once
// Eyes in OpenXR's form, and the placement of their space in the model's world.
//
// The eyes' space is OpenXR's, in metres: x right, y up, z backward. The model's world has the axes and units
// of the model's file. A Placement transforms points of the eyes' space into points of the model's world.

#include <glm/glm.hpp>

namespace binosplat {

// The library is compiled with GLM's unaligned types. With GLM_FORCE_DEFAULT_ALIGNED_GENTYPES a program would
// have structs of another layout.
static_assert(sizeof(glm::vec3) == 3 * sizeof(float) && sizeof(glm::dvec3) == 3 * sizeof(double),
              "binosplat needs GLM without GLM_FORCE_DEFAULT_ALIGNED_GENTYPES");

/// The near plane in world units if no file says the training's: no Gaussian nearer to an eye is drawn. 3D
/// Gaussian Splatting trains with this value, for worlds whose unit is about a metre; gsplat with 0.01.
constexpr double near_default = 0.2;

/// A frustum: the angles of its four sides from the forward axis, in radians, in the order of XrFovf. Left
/// and down are negative if the axis lies inside the frustum. A frustum may be asymmetric, as in headsets.
/// Each angle is below a quarter turn in magnitude; left is less than right, and down less than up.
struct Fov {
  double left = 0;
  double right = 0;
  double up = 0;
  double down = 0;
};

/// One eye, as in XrView. Eyes may be canted: turned away from each other.
struct Eye {
  glm::dvec3 position{0.0};                    // m, in the eyes' space
  glm::dvec4 orientation{0.0, 0.0, 0.0, 1.0};  // quaternion x, y, z, w, as XrQuaternionf; not zero
  Fov fov = {};
};

/// Transforms the eyes' space into the model's world: a point p, in metres, becomes origin + units_per_metre
/// * axes * p. SplatModel::placement() returns a Placement in which the eyes' "up" is the model's.
struct Placement {
  glm::dvec3 origin{0.0};  // world units
  /// Orthonormal columns: the eyes' right, up and backward directions in the world. The default fits most
  /// trained models, whose y axis points down and z axis forward.
  glm::dmat3 axes{1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0};
  /// World units per metre, above 0. Trained models have any scale: if this number is too small, the world
  /// looks too large. The library never changes it.
  double units_per_metre = 1.0;
};

}  // namespace binosplat
