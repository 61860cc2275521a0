#pragma once
// The ply file of a Scaffold-GS model.

#include <filesystem>

#include "scene/scaffold.h"

namespace binosplat {

/// Fills in the anchors, K and F (see scaffold_file.h). Throws Error naming `ply`.
void load_anchors(const std::filesystem::path& ply, Scaffold& scaffold);

}  // namespace binosplat
