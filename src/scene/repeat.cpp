#include "scene/repeat.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "base/error.h"
#include "scene/axes.h"
#include "scene/scaffold.h"

namespace binosplat {

namespace {

constexpr std::uint64_t copies_most = std::uint64_t{1} << 31;

/// Makes `values` so many copies of itself, one after the other.
template <typename T>
void copy_times(std::vector<T>& values, std::size_t times) {
  const std::size_t once = values.size();
  std::vector<T> all;
  all.reserve(once * times);
  for (std::size_t k = 0; k < times; ++k) all.insert(all.end(), values.begin(), values.end());
  values.swap(all);
}

/// Where copies go, in the model's own frame.
struct Grid {
  int nx, nz;
  glm::dmat3 into_frame;
  double spacing;

  std::size_t copies() const { return static_cast<std::size_t>(nx) * static_cast<std::size_t>(nz); }

  /// Puts the copies of `once` positions side by side.
  void move(std::vector<glm::vec3>& positions, std::size_t once) const {
    glm::vec3* p = positions.data();
    for (int i = -((nx - 1) / 2); i <= nx / 2; ++i) {
      for (int j = -((nz - 1) / 2); j <= nz / 2; ++j) {
        for (std::size_t k = 0; k < once; ++k, ++p)
          *p = glm::vec3(glm::dvec3(*p) + into_frame * glm::dvec3(i * spacing, 0.0, j * spacing));
      }
    }
  }
};

/// Copies of the anchors: each copy is seen, and decoded, from where it stands.
std::shared_ptr<Scaffold> repeat(Scaffold s, const Grid& grid) {
  const std::size_t copies = grid.copies();
  const std::size_t once = s.anchor_count();
  copy_times(s.position, copies);
  copy_times(s.offset_scale, copies);
  copy_times(s.scale, copies);
  copy_times(s.rotation, copies);
  copy_times(s.offset, copies);
  copy_times(s.feature, copies);
  grid.move(s.position, once);
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
  const Grid grid{nx, nz, glm::transpose(world_from_axes(model.axes.letters)), spacing};
  if (model.scaffold) {
    Model repeated = stand_in(repeat(*model.scaffold, grid));
    repeated.kernel_px2 = model.kernel_px2;
    repeated.antialiased = model.antialiased;
    repeated.antialiased_by = model.antialiased_by;
    repeated.perspective = model.perspective;
    repeated.axes = model.axes;
    return repeated;
  }
  const std::size_t once = model.count();
  copy_times(model.position, copies);
  copy_times(model.scale, copies);
  copy_times(model.rotation, copies);
  copy_times(model.opacity, copies);
  copy_times(model.sh, copies);
  grid.move(model.position, once);
  return model;
}

}  // namespace binosplat
