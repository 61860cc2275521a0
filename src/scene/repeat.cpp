#include "scene/repeat.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

#include "base/error.h"
#include "scene/axes.h"
#include "scene/scaffold.h"

namespace binosplat {

namespace {

constexpr std::uint64_t copies_most = std::uint64_t{1} << 31;

template <typename T>
void copy_times(std::vector<T>& values, std::size_t times) {
  const std::size_t once = values.size();
  values.resize(once * times);
  for (std::size_t k = once; k < values.size(); ++k) values[k] = values[k - once];
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
  copy_times(positions, moves.size());
  for (std::size_t k = 0; k < positions.size(); ++k)
    positions[k] = glm::vec3(glm::dvec3(positions[k]) + moves[k / once]);
}

/// Repeats the anchors. Decoding uses the eye's direction and distance from each copy.
std::shared_ptr<Scaffold> repeat(Scaffold s, std::span<const glm::dvec3> moves) {
  copy_to(s.position, moves);
  copy_times(s.offset_scale, moves.size());
  copy_times(s.scale, moves.size());
  copy_times(s.rotation, moves.size());
  copy_times(s.offset, moves.size());
  copy_times(s.feature, moves.size());
  return std::make_shared<Scaffold>(std::move(s));
}

}  // namespace

Model repeat(Model model, int nx, int nz, double spacing) {
  if (nx < 1 || nz < 1) fail("--repeat {}x{}: expected at least 1x1", nx, nz);
  const std::uint64_t copies = static_cast<std::uint64_t>(nx) * static_cast<std::uint64_t>(nz);
  if (model.count() > copies_most / copies) {
    fail("--repeat {}x{} of {} Gaussians: more than 2^31 Gaussians; repeat fewer times", nx, nz,
         model.count());
  }
  const double farthest = std::max(nx, nz) * std::abs(spacing);
  if (!std::isfinite(static_cast<float>(farthest))) {
    fail("--spacing {}: expected a distance between copies in world units", spacing);
  }
  const std::vector<glm::dvec3> moves = moves_of(nx, nz, spacing, model.axes);
  if (model.scaffold) {
    Model repeated = placeholder_model(repeat(*model.scaffold, moves));
    repeated.kernel_px2 = model.kernel_px2;
    repeated.antialiased = model.antialiased;
    repeated.antialiased_by = model.antialiased_by;
    repeated.perspective = model.perspective;
    repeated.axes = model.axes;
    return repeated;
  }
  copy_to(model.position, moves);
  copy_times(model.scale, moves.size());
  copy_times(model.rotation, moves.size());
  copy_times(model.opacity, moves.size());
  copy_times(model.sh, moves.size());
  return model;
}

}  // namespace binosplat
