#pragma once
// Projects a Gaussian into a view in float64 (docs/method.md 2; 3D Gaussian Splatting, Kerbl et al. 2023).
// The judge of src/render/project.cpp: both are written from docs/method.md and share only constants and
// structs.

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
};

/// The splat of a Gaussian with PROJECTION_TANGENT (docs/method.md 2). With p = (x, y, 1) of a pixel,
/// q = p^T form p / p^T ray p if facing . p > 0. Elsewhere it is invisible.
struct Cone {
  glm::dmat3 form{0.0};
  glm::dmat3 ray{0.0};  // |d|^2 of the pixel's ray d, with d.z = 1
  /// The Gaussian's mean is behind the eye. The splat's mean is then on the line through both.
  bool is_behind = false;
  glm::dvec3 facing{0.0};  // cosine of the angle to the Gaussian, times |d|
};

/// A Gaussian in one view. Symmetric matrices are stored as (xx, xy, yy).
struct Splat {
  glm::dvec2 mean{0.0};          // px; the centre of pixel (i, j) is (i, j)
  double depth = 0.0;            // view z, world units; with a cone, distance to the eye
  double order = 0.0;            // sorting key, world units
  double opacity = 0.0;          // sigma, in [0, 1]
  glm::dvec3 covariance{0.0};    // C2 in px^2, with the low-pass
  glm::dvec3 conic{0.0};         // Q, the inverse of C2, in px^-2
  double det = 0.0;              // of C2, px^4; with a cone, in px of the picture's middle
  glm::dvec3 colour{0.0};        // display-referred, at least 0, without upper limit
  double threshold = ALPHA_MIN;  // Th: tile tests use the region with alpha >= Th; see threshold.h
  std::optional<Cone> cone;      // with PROJECTION_TANGENT; replaces covariance and conic
  bool drawn = false;            // deeper than the near plane, det > 0, and Th (threshold.h) not above sigma
};

/// The low-pass filter of every splat (docs/method.md 2).
struct LowPass {
  double kernel_px2 = KERNEL_PX2;  // variance, px^2
  bool antialiased = false;        // reduces the opacity of widened splats
};

/// All members except the colour.
Splat project(const Gaussian& gaussian, const shared::View& view, const LowPass& low_pass = {},
              const Perspective& perspective = {});

/// Gaussian `i` of the model in a view, by default in the model's perspective. For Scaffold-GS, projects its
/// stand-in.
Splat project(const Model& model, std::size_t i, const shared::View& view,
              const std::optional<Perspective>& perspective = {});

/// All Gaussians of the model, in its order and perspective. Scaffold-GS is decoded for this view alone, and
/// ordered by id (decode.h).
std::vector<Splat> project_all(const Model& model, const shared::View& view);

/// The colour of Gaussian `i` along the unit vector `direction`, from the eye to the Gaussian in world axes.
glm::dvec3 colour_towards(const Model& model, std::size_t i, const glm::dvec3& direction);

}  // namespace binosplat::reference
