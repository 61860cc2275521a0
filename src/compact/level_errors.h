#pragma once
// Measures the error of levels of detail (LOD): the difference of their pictures from the finest level's.

#include <span>
#include <vector>

#include "compact/streamed_sog_writer.h"
#include "gl/context.h"
#include "scene/model.h"

namespace binosplat::compact {

/// Draws every level of each chunk (`levels_of_chunks`) alone, from far away and from six directions, in
/// pixels of two widths. The background has about the chunk's mean colour. Compares it with the chunk's
/// finest level. A picture holds many chunks side by side. Each chunk has its levels from the finest on, none
/// without Gaussians. To save drawing, opposite directions share one measurement in wide pixels. Levels from
/// 3 on are drawn in wide pixels only; narrow pixels get their error per visible area.
std::vector<LevelErrors> level_errors(gl::Context& context,
                                      std::span<const std::vector<Model>> levels_of_chunks);

}  // namespace binosplat::compact
