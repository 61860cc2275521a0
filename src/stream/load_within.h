#pragma once
// Reads a model at levels of detail that fit into memory and never change.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "scene/model.h"

namespace binosplat {

/// The number of Gaussians that fit, and the eyes for which levels are chosen.
struct DetailBudget {
  std::function<std::size_t(int degree)> gaussians;  // maximum number, with harmonics of a degree
  std::vector<glm::dvec3> eyes;  // in the model's coordinates; empty: all chunks are equally far away
};

/// Chooses a level for each chunk of a streamed SOG (`path`: lod-meta.json or its folder) by
/// choose_by_spacing(), among existing files, and reads the chunks. Throws Error as load_streamed_sog() does,
/// and for other files.
Model load_within(const std::filesystem::path& path, const DetailBudget& budget);

}  // namespace binosplat
