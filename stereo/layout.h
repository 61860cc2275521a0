#pragma once
// Combines two eyes' pictures into one. shaders/shared/layout.h defines the source of each pixel. Shaders
// compile it too, so that files, the preview and a caller's texture show the same.

#include <glm/glm.hpp>

#include "base/image.h"
#include "shared/choices.h"

namespace binosplat::stereo {

/// Whether a layout mixes both eyes' colours. Other layouts place pixels, which keep their depth and
/// coverage.
constexpr bool mixes_colours(int layout) { return layout >= LAYOUT_ANAGLYPH; }

/// Returns the size in px of the picture that a layout makes of two pictures of size `eye`. If the layout
/// keeps two pictures, returns `eye`. Throws Error for LAYOUT_HALF_WIDTH of an odd width, and for
/// LAYOUT_HALF_HEIGHT of an odd height.
glm::ivec2 layout_size(int layout, const glm::ivec2& eye);

/// Returns both eyes' pictures as one. If rows or columns alternate, the first at the top left is the left
/// eye's. Layouts that mix colours need a background, which the picture then includes: its T is 0 and its
/// depth undefined. Throws Error if this background is missing, and for pictures of different sizes. Not for
/// LAYOUT_SEPARATE, LAYOUT_MULTI_VIEW and LAYOUT_QUAD_BUFFER.
Picture lay_out(int layout, const Picture& left, const Picture& right, const Background& background);

}  // namespace binosplat::stereo
