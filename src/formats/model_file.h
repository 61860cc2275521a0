#pragma once
// The entrance for model files: what a file is, is decided by its content, never by its name.

#include <filesystem>

#include "scene/model.h"

namespace binosplat {

/// Reads a trained model: INRIA's ply (formats/ply.h), or Scaffold-GS's with the networks beside it
/// (formats/scaffold_file.h). A folder stands for the point_cloud.ply in it or in its point_cloud/, the
/// latest iteration's. Says on standard error how many Gaussians were left out because a value is not finite
/// or the quaternion is zero. Throws Error for anything that is not such a model; the text says what the file
/// looks like instead.
Model load_model(const std::filesystem::path& path);

}  // namespace binosplat
