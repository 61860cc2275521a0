#pragma once
// Reads a model with levels of detail once, at levels that fit into memory.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "scene/model.h"

namespace binosplat {

/// How much of a model with levels of detail fits, and the eyes for which levels are chosen.
struct DetailBudget {
  std::function<std::size_t(int degree)> gaussians;  // the most that fit, by degree of harmonics
  std::vector<glm::dvec3> eyes;                      // in the model's frame; empty: from far away
};

/// Reads each chunk of a streamed SOG at its own level (choose_by_spacing), from existing files. `path` is a
/// lod-meta.json or its folder. Throws Error as load_streamed_sog() does, and for other files.
Model load_within(const std::filesystem::path& path, const DetailBudget& budget);

}  // namespace binosplat
