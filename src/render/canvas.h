#pragma once
// The caller's images, into which a frame writes its final pictures.

#include <glm/glm.hpp>

#include "shared/types.h"

namespace binosplat::render {

/// The destination of a view's picture: a level and layer of a texture that a compute shader can write in
/// `format`. Rows are OpenGL's: (x, y) is the picture's lower left corner.
struct Canvas {
  std::uint32_t texture = 0;
  GLenum format = GL_RGBA8;
  int level = 0;
  int layer = 0;
  int x = 0, y = 0;               // px
  std::uint32_t keeps_alpha = 0;  // as in shared::Canvas; 0: over settings.background
  bool linear = false;            // the image stores linear light instead of display values
};

/// The largest integer value of a colour channel in this format; 0 for floating-point formats.
constexpr std::uint32_t steps_of(GLenum format) {
  if (format == GL_RGBA8) return 255;
  if (format == GL_RGB10_A2) return 1023;
  return format == GL_RGBA16 ? 65535 : 0;
}

constexpr shared::Canvas on_gpu(const Canvas& canvas) {
  return {.left = static_cast<std::uint32_t>(canvas.x),
          .bottom = static_cast<std::uint32_t>(canvas.y),
          .steps = steps_of(canvas.format),
          .keeps_alpha = canvas.keeps_alpha,
          .linear = canvas.linear};
}

}  // namespace binosplat::render
