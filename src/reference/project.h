#pragma once
// Projects a Gaussian into a view in float64 (docs/method.md 2; 3D Gaussian Splatting, Kerbl et al. 2023).
// Tests compare src/render/project.cpp with this independent version. Only constants and structs are shared.

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "scene/model.h"
#include "shared/limits.h"
#include "shared/types.h"

namespace binosplat::reference {

/// A Gaussian in the world.
struct Gaussian {
  glm::dvec3 position{0.0};                 // world units
  glm::dvec3 scale{0.0};                    // standard deviations, world units
  glm::dvec4 rotation{1.0, 0.0, 0.0, 0.0};  // unit quaternion (w, x, y, z)
  double opacity = 0.0;
  bool is_flat = false;  // Z is on its plane
};

/// The splat of a Gaussian with Projection::tangent (docs/method.md 2). With p = (x, y, 1) for pixel (x, y),
/// q = (p^T form p) / (p^T ray p). The splat is invisible unless facing . p > 0.
struct Cone {
  glm::dmat3 form{0.0};
  glm::dmat3 ray{0.0};  // p^T ray p = |d|^2, with d the pixel's ray and d.z = 1
  /// The Gaussian's mean is behind the eye. The splat's mean then lies on the line through eye and Gaussian.
  bool is_behind = false;
  glm::dvec3 facing{0.0};  // facing . p = |d| times the cosine of the angle between d and the Gaussian
};

/// A Gaussian in one view. Symmetric matrices are stored as (xx, xy, yy).
struct Splat {
  glm::dvec2 mean{0.0};          // px; the centre of pixel (i, j) is (i, j)
  double depth = 0.0;            // view z, world units; with a cone, the distance from the eye
  double order = 0.0;            // sort key, world units
  double opacity = 0.0;          // sigma, in [0, 1]
  glm::dvec3 covariance{0.0};    // C2 in px^2, with the low-pass
  glm::dvec3 conic{0.0};         // Q, the inverse of C2, in px^-2
  double det = 0.0;              // det C2, px^4; with a cone, (fx fy)^2 / det Qt (docs/method.md 2.2)
  glm::dvec3 colour{0.0};        // display-referred, at least 0, without upper limit
  double threshold = ALPHA_MIN;  // Th (threshold.h): tile tests use the region with alpha >= Th
  std::optional<Cone> cone;      // with Projection::tangent; replaces covariance and conic
  bool drawn = false;            // beyond the near plane, and det > 0; set_thresholds() may clear it
  /// Of a flat Gaussian: the ray of pixel (x, y) meets its plane at z = 1 / (plane . (x, y, 1)). Depths are
  /// there, at most `reach` from the mean's z. None if it is seen edge-on or is behind the eye.
  std::optional<glm::dvec3> plane;
  double reach = 0.0;
};

/// The low-pass of all splats of a model (docs/method.md 2).
struct LowPass {
  double kernel_px2 = KERNEL_PX2;  // variance, px^2
  bool antialiased = false;        // true: reduces opacity as the low-pass widens splats
};

/// Projects a Gaussian. Sets all members of the splat except the colour.
Splat project(const Gaussian& gaussian, const shared::View& view, const LowPass& low_pass = {},
              const Perspective& perspective = {});

/// Projects Gaussian `i` of the model, by default with the model's sort order and projection. In a
/// Scaffold-GS model this is not a decoded Gaussian, but the placeholder at this index (scene/scaffold.h).
Splat project(const Model& model, std::size_t i, const shared::View& view,
              const std::optional<Perspective>& perspective = {});

/// Projects all Gaussians of the model, with its sort order and projection. Elements are by index, in
/// Scaffold-GS by id (decode.h). A Scaffold-GS model is decoded for this view alone.
std::vector<Splat> project_all(const Model& model, const shared::View& view);

/// The colour of Gaussian `i`. `direction` is the unit vector from the eye to the Gaussian, in world axes.
glm::dvec3 colour_towards(const Model& model, std::size_t i, const glm::dvec3& direction);

}  // namespace binosplat::reference
