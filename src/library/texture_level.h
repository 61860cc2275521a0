#pragma once
// What the caller's textures are, as far as it decides whether they can be read or drawn into.

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>

#include "gl/context.h"

namespace binosplat::library {

/// Which of the arguments a text is about: "views[1].target".
struct Argument {
  std::size_t view = 0;
  const char* member = "";

  std::string name() const;
};

/// A level of a texture, and a layer of that where the texture is an array; -1: it is none.
struct Place {
  std::uint32_t texture = 0;
  int level = 0;
  int layer = -1;

  bool operator==(const Place&) const = default;
};

struct TextureLevel {
  GLint format = 0;        // GL_TEXTURE_INTERNAL_FORMAT
  bool immutable = false;  // its storage, as glTextureStorage2D makes it
  glm::ivec2 size{0};      // px
};

/// Throws Error(bad_input) for a texture that is not there, or is neither 2D nor a 2D array, and for a level
/// or layer that it lacks. Leaves no error in the context.
TextureLevel texture_level(const gl::Context& context, const Place& place, const Argument& argument);

/// Throws Error(bad_input) for planes of depths that bound nothing.
void check_planes(double near, double far, const Argument& argument);

/// Throws Error(bad_input) unless a picture of `size` px at a corner lies within what there is of it.
void check_within(const glm::ivec2& there, const glm::ivec2& corner, const glm::ivec2& size,
                  const Argument& argument);

}  // namespace binosplat::library
