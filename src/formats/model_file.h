#pragma once
// The entrance for model files: what a file is, is decided by its content, never by its name.

#include <filesystem>

#include "scene/model.h"

namespace binosplat {

/// Reads a trained model; now INRIA's ply (formats/ply.h). Says on standard error how many Gaussians were
/// left out because a value is not finite or the quaternion is zero. Throws Error for anything that is not
/// such a model; the text says what the file looks like instead.
Model load_model(const std::filesystem::path& path);

}  // namespace binosplat
