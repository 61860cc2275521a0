#pragma once
// Measures the error of levels of detail (LOD): the difference of their pictures from the finest level's.

#include <span>
#include <vector>

#include "compact/streamed_sog_writer.h"
#include "gl/context.h"
#include "scene/model.h"

namespace binosplat::compact {

/// Draws every level of each chunk alone, from far away in six directions and in pixels of two widths, and
/// compares it with the chunk's finest level. The background is about the chunk's mean colour.
/// `levels_of_chunks` has each chunk's levels from the finest on, all with Gaussians. To save drawing, a
/// picture holds many chunks, and in wide pixels opposite directions share one measurement. Levels from 3 on
/// are drawn in wide pixels only, and assumed to have the same error per visible area in narrow pixels.
std::vector<LevelErrors> level_errors(gl::Context& context,
                                      std::span<const std::vector<Model>> levels_of_chunks);

}  // namespace binosplat::compact
