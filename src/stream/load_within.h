#pragma once
// A model with levels of detail that is read once, at levels for which there is room.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "scene/model.h"

namespace binosplat {

/// How much of a model with levels of detail may be there, and from where it is looked at.
struct DetailBudget {
  std::function<std::size_t(int degree)> gaussians;  // how many at most, with harmonics of a degree
  std::vector<glm::dvec3> eyes;                      // in the model's frame; empty: as if from far away
};

/// Reads each leaf of a streamed SOG at a level of its own (choose_apart), among those whose files are
/// there. `path`: a lod-meta.json or the folder of one. Throws Error as load_streamed_sog() does, and where
/// it is anything else.
Model load_within(const std::filesystem::path& path, const DetailBudget& budget);

}  // namespace binosplat
