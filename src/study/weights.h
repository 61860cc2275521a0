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
  /// What a Gaussian's colour loses towards these views where its harmonics end with a degree, summed
  /// likewise with its weight; px * colour, and the mean square over channels.
  struct Lowered {
    glm::dvec3 lost{0.0};
    double square = 0.0;
  };
  std::vector<std::array<Lowered, 3>> lowered;  // by Gaussian and degree

  /// How many Gaussians touch no pixel of any view.
  std::size_t unseen() const;
  /// What a base colour must gain where harmonics end with a degree, so that the mean colour towards these
  /// views stays.
  glm::vec3 shift(std::size_t gaussian, std::size_t degree) const;
  /// How much the colour then still changes, px * squared colour.
  double change(std::size_t gaussian, std::size_t degree) const;
};

/// What the pictures of the views would change by without each Gaussian alone, squared and summed
/// (render::LinearBlend::changes). As weigh().
std::vector<double> changes_without(gl::Context& context, const Model& model,
                                    const std::vector<Camera>& cameras, double near_plane);

/// Draws each view once, exactly. `cameras` are of the world (scene/axes.h), `near_plane` in its units.
/// Progress is shown.
Weights weigh(gl::Context& context, const Model& model, const std::vector<Camera>& cameras,
              double near_plane);

}  // namespace binosplat::study
