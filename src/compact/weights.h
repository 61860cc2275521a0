#pragma once
// What each Gaussian of a model is worth in some views.

#include <vector>

#include "compact/colour_fit.h"
#include "gl/context.h"
#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat::compact {

struct Weights {
  std::size_t views = 0;
  /// By Gaussian: its blending weight alpha * T summed over the pixels of all views, px; 0 exactly where no
  /// pixel blends it.
  std::vector<double> weight;
  std::vector<ColourFit> colours;  // by Gaussian, where asked for

  /// How many Gaussians touch no pixel of any view.
  std::size_t unseen() const;
};

/// What the pictures of the views would change by without each Gaussian alone, squared and summed
/// (render::LinearBlend::changes). As weigh().
std::vector<double> changes_without(gl::Context& context, const Model& model,
                                    const std::vector<Camera>& cameras, double near_plane);

/// Draws each view once, exactly. `cameras` are of the world (scene/axes.h), `near_plane` in its units.
/// Progress is shown.
Weights weigh(gl::Context& context, const Model& model, const std::vector<Camera>& cameras, double near_plane,
              bool with_colours = false);

}  // namespace binosplat::compact
