#include "scene/repeat.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/error.h"
#include "scene/axes.h"

namespace binosplat {

namespace {

constexpr std::uint64_t most = std::uint64_t{1} << 31;

/// Makes `values` so many copies of itself, one after the other.
template <typename T>
void copy_times(std::vector<T>& values, std::size_t times) {
  const std::size_t once = values.size();
  std::vector<T> all;
  all.reserve(once * times);
  for (std::size_t k = 0; k < times; ++k) all.insert(all.end(), values.begin(), values.end());
  values.swap(all);
}

}  // namespace

Model repeat(Model model, int nx, int nz, double spacing) {
  if (nx < 1 || nz < 1) fail("--repeat {}x{}: expected at least 1x1", nx, nz);
  const std::uint64_t copies = static_cast<std::uint64_t>(nx) * static_cast<std::uint64_t>(nz);
  if (model.count() > most / copies) {
    fail("--repeat {}x{} of {} Gaussians: more than 2^31 Gaussians; repeat fewer times", nx, nz,
         model.count());
  }
  const double farthest = std::max(nx, nz) * std::abs(spacing);
  if (!std::isfinite(static_cast<float>(farthest))) {
    fail("--spacing {}: expected a distance between copies in world units", spacing);
  }
  const std::size_t once = model.count();
  copy_times(model.position, copies);
  copy_times(model.scale, copies);
  copy_times(model.rotation, copies);
  copy_times(model.opacity, copies);
  copy_times(model.sh, copies);
  glm::vec3* p = model.position.data();
  const glm::dmat3 into_frame = glm::transpose(world_from_axes(model.axes));
  for (int i = -((nx - 1) / 2); i <= nx / 2; ++i) {
    for (int j = -((nz - 1) / 2); j <= nz / 2; ++j) {
      for (std::size_t k = 0; k < once; ++k, ++p)
        *p = glm::vec3(glm::dvec3(*p) + into_frame * glm::dvec3(i * spacing, 0.0, j * spacing));
    }
  }
  return model;
}

}  // namespace binosplat
