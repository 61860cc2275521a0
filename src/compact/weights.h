#pragma once
// Measures the contribution of each Gaussian of a model to some views.

#include <vector>

#include "compact/harmonics_fit.h"
#include "gl/context.h"
#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat::compact {

struct Weights {
  std::size_t views = 0;
  /// By Gaussian: alpha * T summed over the pixels of all views, px; exactly 0 if no pixel blends it.
  std::vector<double> weight;
  std::vector<HarmonicsFit> colours;  // by Gaussian, if requested

  /// Returns how many Gaussians touch no pixel of any view.
  std::size_t unseen() const;
};

/// Returns for each Gaussian the squared change of the views' pictures if it alone is removed, summed over
/// pixels, channels and views (render::LinearBlend::changes). Parameters as for weigh().
std::vector<double> changes_without(gl::Context& context, const Model& model,
                                    const std::vector<Camera>& cameras, double near_plane);

/// Draws each view once, exactly. `cameras` and `near_plane` are in world coordinates. Shows progress.
Weights weigh(gl::Context& context, const Model& model, const std::vector<Camera>& cameras, double near_plane,
              bool with_colours = false);

}  // namespace binosplat::compact
