#pragma once
// What levels of detail lose, as pictures show it.

#include <span>
#include <vector>

#include "formats/streamed_sog_writer.h"
#include "gl/context.h"
#include "scene/model.h"

namespace binosplat::study {

/// Draws each part by itself over black, exactly, by each of its levels, from afar and from two directions,
/// and compares with its finest level, in pixels of six widths. Many parts lie side by side in a picture.
/// Each part is the levels of a leaf, from the finest; none is without Gaussians.
std::vector<LeafErrors> level_errors(gl::Context& context, std::span<const std::vector<Model>> parts);

}  // namespace binosplat::study
