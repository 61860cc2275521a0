#include "scene/repeat.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "scene/axes.h"
#include "scene/core.h"
#include "scene/scaffold.h"

namespace binosplat {

namespace {

constexpr std::uint64_t max_repeated_gaussians = std::uint64_t{1} << 31;

template <typename... T>
void copy_times(std::size_t times, std::vector<T>&... all) {
  const auto copy = [times](auto& values) {
    const std::size_t once = values.size();
    values.resize(once * times);
    for (std::size_t k = once; k < values.size(); ++k) values[k] = values[k - once];
  };
  (copy(all), ...);
}

/// Returns each copy's translation, in the model's own frame.
std::vector<glm::dvec3> moves_of(int nx, int nz, double spacing, const ModelAxes& axes) {
  const glm::dmat3 into_frame = glm::transpose(world_from_axes(axes.letters));
  std::vector<glm::dvec3> moves;
  for (int i = -((nx - 1) / 2); i <= nx / 2; ++i) {
    for (int j = -((nz - 1) / 2); j <= nz / 2; ++j)
      moves.push_back(into_frame * glm::dvec3(i * spacing, 0.0, j * spacing));
  }
  return moves;
}

/// Repeats positions, and adds each copy's translation.
void copy_to(std::vector<glm::vec3>& positions, std::span<const glm::dvec3> moves) {
  const std::size_t once = positions.size();
  copy_times(moves.size(), positions);
  for (std::size_t k = 0; k < positions.size(); ++k)
    positions[k] = glm::vec3(glm::dvec3(positions[k]) + moves[k / once]);
}

/// Repeats the anchors. Decoding uses the eye's direction and distance from each copy.
std::shared_ptr<Scaffold> repeat(Scaffold s, std::span<const glm::dvec3> moves) {
  copy_to(s.position, moves);
  copy_times(moves.size(), s.offset_scale, s.scale, s.rotation, s.offset, s.feature);
  return std::make_shared<Scaffold>(std::move(s));
}

}  // namespace

Model repeat(Model model, int nx, int nz, double spacing, std::span<const Camera> cameras) {
  if (nx < 1 || nz < 1) fail("`repeat` {}x{}: expected at least 1x1", nx, nz);
  const std::uint64_t copies = static_cast<std::uint64_t>(nx) * static_cast<std::uint64_t>(nz);
  if (model.count() > max_repeated_gaussians / copies)
    fail("`repeat` {}x{} of {} Gaussians has more than 2^31: repeat fewer times", nx, nz, model.count());
  const double farthest = std::max(nx, nz) * std::abs(spacing);
  if (!std::isfinite(static_cast<float>(farthest)))
    fail("`spacing` {}: expected a distance between copies in world units", spacing);
  std::vector<glm::dvec3> moves = moves_of(nx, nz, spacing, model.axes);
  const glm::dvec3 by = move_near(cameras, farthest / core_of(model).radius, model.axes);
  for (glm::dvec3& move : moves) move -= by;
  if (model.scaffold) {
    Model repeated = placeholder_model(repeat(*model.scaffold, moves));
    repeated.set_training(model);
    repeated.axes = model.axes;
    return repeated;
  }
  copy_to(model.position, moves);
  copy_times(moves.size(), model.scale, model.rotation, model.opacity, model.sh);
  return model;
}

glm::dvec3 move_near(std::span<const Camera> cameras, double radii, ModelAxes& axes) {
  glm::dvec3 by(0.0);
  if (radii > 1024.0 && !cameras.empty()) by = into_axes(cameras[0].position, axes);  // choose_origin()
  axes.origin += by;
  if (radii > 16384.0)
    log_warning(
        "models far from {} are rounded to floats (name `cameras` at one place, or convert one by one)",
        cameras.empty() ? "the first" : "camera " + cameras[0].name);
  return by;
}

}  // namespace binosplat
