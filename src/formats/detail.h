#pragma once
// Which level of detail each part of a model gets, where there is room for so many Gaussians.

#include <cstddef>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace binosplat {

/// How much of a model with levels of detail may be there, and from where it is looked at.
struct DetailBudget {
  std::function<std::size_t(int degree)> gaussians;  // at most so many, where they have harmonics of a degree
  std::vector<glm::dvec3> eyes;                      // in the model's frame; empty: as if from far away
};

/// A part of a model: its box, and its levels from the finest to the coarsest.
struct DetailPart {
  struct Level {
    int number = 0;
    std::size_t count = 0;  // Gaussians
  };
  glm::dvec3 low{0.0}, high{0.0};
  std::vector<Level> levels;  // may be empty
};

/// For each part the place of its level in `levels`. All begin with their coarsest; then, as long as there is
/// room, that part gets its next finer one whose Gaussians lie farthest apart as the nearest eye sees them:
/// the box's diagonal by the root of the count, over the distance to the box, in radians; parts where that is
/// no more than `enough` stay as they are. The choice is one for all eyes. More than `most` only if the
/// coarsest levels are more already. `before`, a choice for the same parts, is kept to where the eyes have
/// moved by little: its levels count as a tenth more needed, finer ones as a tenth less.
std::vector<std::size_t> choose_levels(const std::vector<DetailPart>& parts,
                                       const std::vector<glm::dvec3>& eyes, std::size_t most,
                                       double enough = 0.0, std::span<const std::size_t> before = {});

}  // namespace binosplat
