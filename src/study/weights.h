#pragma once
// What each Gaussian of a model is worth in some views.

#include <array>
#include <vector>

#include "gl/context.h"
#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat::study {

struct Weights {
  std::size_t views = 0;
  /// By Gaussian: its blending weight alpha * T summed over the pixels of all views, px; 0 exactly where no
  /// pixel blends it.
  std::vector<double> weight;
  /// By Gaussian and degree: how much its colour changes towards these views where its harmonics end with
  /// that degree, as px * squared colour: the weight times the square (mean over channels), summed likewise.
  std::vector<std::array<double, 3>> change;

  /// How many Gaussians touch no pixel of any view.
  std::size_t unseen() const;
};

/// Draws each view once, exactly. `cameras` are of the world (scene/axes.h), `near_plane` in its units.
/// Progress is shown.
Weights weigh(gl::Context& context, const Model& model, const std::vector<Camera>& cameras,
              double near_plane);

}  // namespace binosplat::study
