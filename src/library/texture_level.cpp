#include "library/texture_level.h"

#include "base/error.h"

namespace binosplat::library {

std::string Argument::name() const { return fmt::format("views[{}].{}", view, member); }

TextureLevel texture_level(const gl::Context& context, const Place& place, const Argument& argument) {
  const gl::Functions& gl = context.gl();
  const std::uint32_t texture = place.texture;
  const auto of_texture = [&](GLenum what) {
    GLint value = 0;
    gl.GetTextureParameteriv(texture, what, &value);
    return value;
  };
  const auto of_level = [&](GLenum what) {
    GLint value = 0;
    gl.GetTextureLevelParameteriv(texture, place.level, what, &value);
    return value;
  };
  const GLint kind = of_texture(GL_TEXTURE_TARGET);
  if (gl.GetError() != GL_NO_ERROR || kind == 0) {
    fail("{}: there is no texture {} in the context: it was deleted, or never bound or given storage",
         argument.name(), texture);
  }
  const bool is_array = kind == GL_TEXTURE_2D_ARRAY;
  if (kind != GL_TEXTURE_2D && !is_array) {
    fail("{}: texture {} is of kind 0x{:04x}: expected GL_TEXTURE_2D or GL_TEXTURE_2D_ARRAY, without samples",
         argument.name(), texture, kind);
  }
  TextureLevel level;
  level.size = {of_level(GL_TEXTURE_WIDTH), of_level(GL_TEXTURE_HEIGHT)};
  if (gl.GetError() != GL_NO_ERROR || level.size.x == 0)
    fail("{}: texture {} has no level {}", argument.name(), texture, place.level);
  const int layers = is_array ? of_level(GL_TEXTURE_DEPTH) : 0;
  if (is_array ? place.layer < 0 || place.layer >= layers : place.layer >= 0) {
    fail("{}: texture {} has no layer {}: it {}", argument.name(), texture, place.layer,
         is_array ? fmt::format("is an array of {}", layers) : "is not an array: expected layer -1");
  }
  level.format = of_level(GL_TEXTURE_INTERNAL_FORMAT);
  level.immutable = of_texture(GL_TEXTURE_IMMUTABLE_FORMAT) != 0;
  return level;
}

void check_planes(double near, double far, const Argument& argument) {
  if (near > 0.0 && far > 0.0 && near != far) return;
  fail("{}: planes at {} and {}: expected two different distances above 0; one may be infinite",
       argument.name(), near, far);
}

void check_within(const glm::ivec2& there, const glm::ivec2& corner, const glm::ivec2& size,
                  const Argument& argument) {
  if (corner.x >= 0 && corner.y >= 0 && size.x <= there.x - corner.x && size.y <= there.y - corner.y) return;
  fail("{}: a picture of {} x {} px at {}, {} does not lie within {} x {} px", argument.name(), size.x,
       size.y, corner.x, corner.y, there.x, there.y);
}

}  // namespace binosplat::library
