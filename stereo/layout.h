#pragma once
// Combines two eyes into one picture. shaders/shared/layout.h maps the pixels; shaders compile it too, so
// that files, the preview and a caller's texture show the same.

#include <glm/glm.hpp>

#include "base/image.h"
#include "shared/axes.h"

namespace binosplat::stereo {

/// Whether a layout mixes both eyes' colours. Other layouts place pixels, which keep their depth and
/// coverage.
constexpr bool mixes_colours(int layout) { return layout >= LAYOUT_ANAGLYPH; }

/// Size in px of the picture that a layout makes of two of size `eye`. Layouts without a single picture have
/// the size of an eye. Throws Error for LAYOUT_HALF_WIDTH of an odd width.
glm::ivec2 layout_size(int layout, const glm::ivec2& eye);

/// Returns both eyes as one picture; rows and columns count from the top left, the left eye's first. Layouts
/// that mix colours need a background, which the picture includes: its T is 0 and its depth undefined. Throws
/// Error without that background, and for pictures of different sizes. Not for LAYOUT_SEPARATE,
/// LAYOUT_MULTI_VIEW and LAYOUT_QUAD_BUFFER.
Picture lay_out(int layout, const Picture& left, const Picture& right, const Background& background);

}  // namespace binosplat::stereo
