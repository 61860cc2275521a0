#include "study/weights.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/progress.h"
#include "render/linear_blend.h"
#include "scene/axes.h"
#include "scene/harmonics.h"

namespace binosplat::study {

namespace {

/// The colour of Gaussian i towards a unit direction, less 0.5.
glm::dvec3 colour_of(const Model& model, std::size_t i, const std::array<double, 16>& basis) {
  const auto count = static_cast<std::size_t>(sh_count(model.degree));
  const float* sh = &model.sh[3 * count * i];
  glm::dvec3 sum(0.0);
  for (std::size_t k = 0; k < count; ++k)
    sum += basis[k] * glm::dvec3(sh[3 * k], sh[3 * k + 1], sh[3 * k + 2]);
  return glm::max(sum, -0.5);
}

}  // namespace

std::size_t Weights::unseen() const {
  return static_cast<std::size_t>(std::count(weight.begin(), weight.end(), 0.0));
}

Weights weigh(gl::Context& context, const Model& model, const std::vector<Camera>& cameras,
              double near_plane) {
  Weights weights{cameras.size(), std::vector<double>(model.count()), {}};
  if (model.degree > 0 && !model.scaffold) weights.colours.resize(model.count());
  render::LinearBlend blend(context, model);
  Progress progress("weighing the Gaussians in every view", cameras.size());
  std::size_t done = 0;
  for (const Camera& in_world : cameras) {
    const Camera camera = into_axes(in_world, model.axes);
    blend.set_view(make_view(camera, near_plane));
    const std::size_t pixels =
        static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
    blend.set_picture(std::vector<glm::vec4>(pixels, {1, 0, 0, 0}));
    const std::vector<glm::dvec4> sums = blend.transposed(1.0f);
    parallel_for(sums.size(), [&](std::size_t k) {
      const std::size_t i = blend.drawn()[k].index;
      const double weight = sums[k].x;
      if (weight == 0.0) return;
      weights.weight[i] += weight;
      if (weights.colours.empty()) return;
      const auto basis = sh_basis(glm::normalize(glm::dvec3(model.position[i]) - camera.position));
      weights.colours[i].add(basis, colour_of(model, i, basis), weight);
    });
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

}  // namespace binosplat::study
