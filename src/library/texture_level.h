#pragma once
// The properties of the caller's textures that decide whether they can be read or drawn into.

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>

#include "gl/context.h"

namespace binosplat::library {

/// Names an argument in error messages, such as "views[1].target".
struct Argument {
  std::size_t view = 0;
  const char* member = "";

  std::string name() const;
};

/// A level of a texture. `layer` selects a layer of an array; -1: the texture is no array.
struct Place {
  std::uint32_t texture = 0;
  int level = 0;
  int layer = -1;

  bool operator==(const Place&) const = default;
};

struct TextureLevel {
  GLint format = 0;        // GL_TEXTURE_INTERNAL_FORMAT
  bool immutable = false;  // whether glTextureStorage2D or the like made the storage
  glm::ivec2 size{0};      // px
};

/// Reads the properties. Throws Error(bad_input) if the texture, level or layer does not exist, and if the
/// texture is neither 2D nor a 2D array. Leaves no OpenGL error.
TextureLevel texture_level(const gl::Context& context, const Place& place, const Argument& argument);

/// Throws Error(bad_input) unless near and far are positive and different.
void check_planes(double near, double far, const Argument& argument);

/// Throws Error(bad_input) unless a picture of `size` px at `corner` lies within a target of `there` px.
void check_within(const glm::ivec2& there, const glm::ivec2& corner, const glm::ivec2& size,
                  const Argument& argument);

}  // namespace binosplat::library
