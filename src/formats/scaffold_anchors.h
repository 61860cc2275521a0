#pragma once
// The ply file of a Scaffold-GS model.

#include "formats/opened_file.h"
#include "scene/scaffold.h"

namespace binosplat {

/// Fills in the anchors, K and F (see scaffold_file.h). Throws Error naming the file.
void load_anchors(const OpenedFile& ply, Scaffold& scaffold);

}  // namespace binosplat
