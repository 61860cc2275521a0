#include "compact/weights.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/progress.h"
#include "render/linear_blend.h"
#include "scene/axes.h"
#include "scene/harmonics.h"

namespace binosplat::compact {

std::size_t Weights::unseen() const {
  return static_cast<std::size_t>(std::count(weight.begin(), weight.end(), 0.0));
}

Weights weigh(gl::Context& context, const Model& model, const std::vector<Camera>& cameras, double near_plane,
              bool with_colours) {
  Weights weights{cameras.size(), std::vector<double>(model.count()), {}};
  if (with_colours) weights.colours.resize(model.count());
  const auto values = 3 * static_cast<std::size_t>(sh_count(model.degree));
  render::LinearBlend blend(context, model);
  Progress progress("summing the Gaussians' weights in every view", cameras.size());
  std::size_t done = 0;
  for (const Camera& in_world : cameras) {
    const Camera camera = into_axes(in_world, model.axes);
    blend.set_view(make_view(camera, near_plane));
    const std::size_t pixels =
        static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
    blend.set_picture(std::vector<glm::vec4>(pixels, {1, 0, 0, 0}));
    const std::vector<glm::dvec4> sums = blend.transposed(1.0f);
    const auto add = [&](std::size_t k) {
      const std::size_t i = blend.drawn()[k].index;
      const double weight = sums[k].x;
      weights.weight[i] += weight;
      if (weight == 0.0 || weights.colours.empty()) return;
      const auto basis = sh_basis(glm::normalize(glm::dvec3(model.position[i]) - camera.position));
      const glm::dvec3 colour = sh_sum(std::span(model.sh).subspan(i * values, values), basis);
      weights.colours[i].add(basis, glm::max(colour, -0.5), weight);
    };
    parallel_for(sums.size(), add, 256);
    progress.update(++done);
  }
  return weights;
}

std::vector<double> changes_without(gl::Context& context, const Model& model,
                                    const std::vector<Camera>& cameras, double near_plane) {
  std::vector<double> changes(model.count());
  render::LinearBlend blend(context, model);
  Progress progress("leaving out each Gaussian in every view", cameras.size());
  std::size_t done = 0;
  for (const Camera& camera : cameras) {
    blend.set_view(make_view(into_axes(camera, model.axes), near_plane));
    const std::vector<double> of_view = blend.changes();
    for (std::size_t k = 0; k < of_view.size(); ++k) changes[blend.drawn()[k].index] += of_view[k];
    progress.update(++done);
  }
  return changes;
}

}  // namespace binosplat::compact
