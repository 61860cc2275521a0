#pragma once
// Two eyes as one picture. How a pixel is made stands in shaders/shared/layout.h, which shaders compile too:
// files, the preview and a caller's texture show the same.

#include <glm/glm.hpp>

#include "base/image.h"
#include "shared/axes.h"

namespace binosplat::stereo {

/// Whether a layout places pixels, which keep their depth and coverage, or mixes both eyes' colours.
constexpr bool mixes_colours(int layout) { return layout >= LAYOUT_ANAGLYPH; }

/// Size in px of the picture that a layout makes of two of size `eye`. Throws Error for LAYOUT_HALF_WIDTH of
/// an odd width. Those that are no single picture have the size of an eye.
glm::ivec2 layout_size(int layout, const glm::ivec2& eye);

/// Both eyes as one picture, rows and columns counted from the top left, the left eye's first. Layouts that
/// mix colours take the background into the picture, whose T is 0 and whose depth means nothing: they need
/// one, and throw Error without. So do pictures of different sizes. Not for
/// LAYOUT_SEPARATE, LAYOUT_MULTI_VIEW and LAYOUT_QUAD_BUFFER.
Picture lay_out(int layout, const Picture& left, const Picture& right, const Background& background);

}  // namespace binosplat::stereo
