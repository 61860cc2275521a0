#pragma once
// A Gaussian as one view sees it, in float64 (docs/method.md 2; 3D Gaussian Splatting, Kerbl et al. 2023).
// The judge of src/render/project.cpp: both are written from docs/method.md and share constants and structs
// only.

#include <cstddef>
#include <glm/glm.hpp>
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

/// One Gaussian in one view. Symmetric matrices are kept as (xx, xy, yy).
struct Splat {
  glm::dvec2 mean{0.0};          // px; the centre of pixel (i, j) lies at (i, j)
  double depth = 0.0;            // view z, world units
  double opacity = 0.0;          // sigma, in [0, 1]
  glm::dvec3 covariance{0.0};    // C2 in px^2, low-pass included
  glm::dvec3 conic{0.0};         // Q, the inverse of C2, in px^-2
  double det = 0.0;              // of C2, px^4
  glm::dvec3 colour{0.0};        // display-referred, not below 0, without an upper limit
  double threshold = ALPHA_MIN;  // Th, the alpha whose reach the tile tests go by; see threshold.h
  bool drawn = false;            // deeper than the near plane, det > 0, and Th (threshold.h) not above sigma
};

/// What widens every splat (docs/method.md 2).
struct LowPass {
  double kernel_px2 = KERNEL_PX2;  // variance, px^2
  bool antialiased = false;        // the opacity falls as the splat is widened
};

/// Everything but the colour.
Splat project(const Gaussian& gaussian, const shared::View& view, const LowPass& low_pass = {});

/// Gaussian `i` of the model in a view; of Scaffold-GS its stand-in.
Splat project(const Model& model, std::size_t i, const shared::View& view);

/// All Gaussians of the model, in its order; of Scaffold-GS by id, as the view by itself has them (decode.h).
std::vector<Splat> project_all(const Model& model, const shared::View& view);

/// The colour of Gaussian `i` seen along the unit vector `direction`, from the eye to the Gaussian in world
/// axes.
glm::dvec3 colour_towards(const Model& model, std::size_t i, const glm::dvec3& direction);

}  // namespace binosplat::reference
