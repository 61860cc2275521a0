#pragma once
// What levels of detail lose, as pictures show it.

#include <span>
#include <vector>

#include "gl/context.h"
#include "lab/streamed_sog_writer.h"
#include "scene/model.h"

namespace binosplat::lab {

/// Draws each leaf by itself over what looks much like its mean colour, exactly, by each of its levels, from
/// afar and from six directions, and compares with its finest level, in pixels of two widths. Many leaves lie
/// side by side in a picture. Each has its levels from the finest on; none is without Gaussians. In the wide
/// pixels both sides are taken to look alike, and in the narrow ones levels beyond the second to lose as much
/// of each area as in the wide.
std::vector<LeafErrors> level_errors(gl::Context& context, std::span<const std::vector<Model>> leaves);

}  // namespace binosplat::lab
