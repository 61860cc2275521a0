#pragma once
// Images of the caller's that a frame's pictures are written into as they are shown.

#include <glm/glm.hpp>

#include "gl/functions.h"
#include "shared/types.h"

namespace binosplat::render {

/// Where the picture of a view goes: a level and layer of a texture that a compute shader can write as this
/// format. Rows are OpenGL's: (x, y) is the picture's lower left corner.
struct Canvas {
  std::uint32_t texture = 0;
  GLenum format = GL_RGBA8;
  int level = 0;
  int layer = 0;
  int x = 0, y = 0;          // px
  bool keeps_alpha = false;  // without a background, colours premultiplied; else over settings.background
  bool linear = false;       // its numbers mean light, not what a screen takes
};

/// Values above 0 of such an image's colours; 0: they are floats.
constexpr std::uint32_t steps_of(GLenum format) {
  if (format == GL_RGBA8) return 255;
  if (format == GL_RGB10_A2) return 1023;
  return format == GL_RGBA16 ? 65535 : 0;
}

/// The canvas as shaders have it.
constexpr shared::Canvas on_gpu(const Canvas& canvas) {
  return {.left = static_cast<std::uint32_t>(canvas.x),
          .bottom = static_cast<std::uint32_t>(canvas.y),
          .steps = steps_of(canvas.format),
          .keeps_alpha = canvas.keeps_alpha,
          .linear = canvas.linear};
}

}  // namespace binosplat::render
