#pragma once
// Measures the error of levels of detail (LOD): the difference between their pictures and the finest level's.

#include <span>
#include <vector>

#include "compact/streamed_sog_writer.h"
#include "gl/context.h"
#include "scene/model.h"

namespace binosplat::compact {

/// Draws every level of each leaf by itself, before a background of about its mean colour, from far away and
/// from six directions, in pixels of two widths, and compares it with the leaf's finest level. A picture
/// holds many leaves side by side. `leaves` have their levels from the finest on, none without Gaussians. To
/// draw less, opposite directions share one measurement in the wide pixels, and levels beyond the second are
/// drawn in the wide pixels alone, whose error per area is taken for the narrow ones, too.
std::vector<LeafErrors> level_errors(gl::Context& context, std::span<const std::vector<Model>> leaves);

}  // namespace binosplat::compact
