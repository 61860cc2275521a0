#pragma once
// A Gaussian as one view sees it, in float64 (docs/method.md 2; 3D Gaussian Splatting, Kerbl et al. 2023).
// The judge of src/render/project.cpp: both are written from docs/method.md and share constants and structs
// only.

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

/// What a ray sees of a Gaussian with PROJECTION_TANGENT (docs/method.md 2): with p = (x, y, 1) of a pixel,
/// q = p^T form p / p^T ray p where facing . p > 0, and nothing elsewhere.
struct Cone {
  glm::dmat3 form{0.0};
  glm::dmat3 ray{0.0};  // |d|^2 of the pixel's ray d, whose d.z is 1
  bool is_behind =
      false;  // the Gaussian's mean, of the eye: the splat's is then where their line meets the picture
  glm::dvec3 facing{0.0};  // the cosine of the angle to the Gaussian, times |d|
};

/// One Gaussian in one view. Symmetric matrices are kept as (xx, xy, yy).
struct Splat {
  glm::dvec2 mean{0.0};          // px; the centre of pixel (i, j) lies at (i, j)
  double depth = 0.0;            // view z, world units; with a cone the distance to the eye
  double order = 0.0;            // what splats are sorted by, world units
  double opacity = 0.0;          // sigma, in [0, 1]
  glm::dvec3 covariance{0.0};    // C2 in px^2, low-pass included
  glm::dvec3 conic{0.0};         // Q, the inverse of C2, in px^-2
  double det = 0.0;              // of C2, px^4; with a cone in px of the picture's middle
  glm::dvec3 colour{0.0};        // display-referred, not below 0, without an upper limit
  double threshold = ALPHA_MIN;  // Th, the alpha whose reach the tile tests use; see threshold.h
  std::optional<Cone> cone;      // with PROJECTION_TANGENT, in the place of covariance
                                 // and conic
  bool drawn = false;            // deeper than the near plane, det > 0, and Th (threshold.h) not above sigma
};

/// What widens every splat (docs/method.md 2).
struct LowPass {
  double kernel_px2 = KERNEL_PX2;  // variance, px^2
  bool antialiased = false;        // the opacity falls as the splat is widened
};

/// Everything but the colour.
Splat project(const Gaussian& gaussian, const shared::View& view, const LowPass& low_pass = {},
              const Perspective& perspective = {});

/// Gaussian `i` of the model in a view, in the model's own perspective where none is given; of Scaffold-GS
/// its stand-in.
Splat project(const Model& model, std::size_t i, const shared::View& view,
              const std::optional<Perspective>& perspective = {});

/// All Gaussians of the model, in its order and its own perspective; of Scaffold-GS by id, as the view by
/// itself has them (decode.h).
std::vector<Splat> project_all(const Model& model, const shared::View& view);

/// The colour of Gaussian `i` seen along the unit vector `direction`, from the eye to the Gaussian in world
/// axes.
glm::dvec3 colour_towards(const Model& model, std::size_t i, const glm::dvec3& direction);

}  // namespace binosplat::reference
