#include "study/weights.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/progress.h"
#include "render/linear_blend.h"
#include "scene/axes.h"
#include "scene/harmonics.h"

namespace binosplat::study {

namespace {

/// Adds what ending with each degree takes from the colour of Gaussian i towards a unit direction.
void add_lost(std::array<Weights::Lowered, 3>& lowered, const Model& model, std::size_t i,
              const glm::dvec3& towards, double weight) {
  const std::array<double, 16> basis = sh_basis(towards);
  const auto count = static_cast<std::size_t>(sh_count(model.degree));
  const float* sh = &model.sh[3 * count * i];
  std::array<glm::dvec3, 4> colour;  // by the degree that the sum ends with
  glm::dvec3 sum(0.5);
  for (std::size_t k = 0, degree = 0; k < count; ++k) {
    sum += basis[k] * glm::dvec3(sh[3 * k], sh[3 * k + 1], sh[3 * k + 2]);
    if (k + 1 == (degree + 1) * (degree + 1)) colour[degree++] = glm::max(sum, 0.0);
  }
  const auto last = static_cast<std::size_t>(model.degree);
  for (std::size_t degree = 0; degree < last; ++degree) {
    const glm::dvec3 lost = colour[last] - colour[degree];
    lowered[degree].lost += weight * lost;
    lowered[degree].square += weight * glm::dot(lost, lost) / 3.0;
  }
}

}  // namespace

std::size_t Weights::unseen() const {
  return static_cast<std::size_t>(std::count(weight.begin(), weight.end(), 0.0));
}

glm::vec3 Weights::shift(std::size_t gaussian, std::size_t degree) const {
  const double sum = weight[gaussian];
  return sum > 0.0 ? glm::vec3(lowered[gaussian][degree].lost / sum) : glm::vec3(0.0f);
}

double Weights::change(std::size_t gaussian, std::size_t degree) const {
  if (weight[gaussian] == 0.0) return 0.0;
  const auto& [lost, square] = lowered[gaussian][degree];
  return std::max(0.0, square - glm::dot(lost, lost) / (3.0 * weight[gaussian]));
}

Weights weigh(gl::Context& context, const Model& model, const std::vector<Camera>& cameras,
              double near_plane) {
  Weights weights{cameras.size(), std::vector<double>(model.count()),
                  std::vector<std::array<Weights::Lowered, 3>>(model.count())};
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
      if (model.degree == 0 || model.scaffold) return;
      const glm::dvec3 towards = glm::normalize(glm::dvec3(model.position[i]) - camera.position);
      add_lost(weights.lowered[i], model, i, towards, weight);
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
