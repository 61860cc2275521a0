#include "library/mesh_depth.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"

namespace binosplat::library {

namespace {

constexpr std::array formats = {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT16,
                                GL_DEPTH24_STENCIL8,   GL_DEPTH32F_STENCIL8, GL_R32F};

/// Returns the texture. If it is an array, or the caller's parameters change what shaders read from it,
/// returns a texture view instead, which it appends to `views`.
std::uint32_t texture_of(gl::Context& context, const MeshDepth& mesh, const Argument& argument,
                         const glm::ivec2& size, std::vector<std::unique_ptr<gl::Texture>>& views) {
  const gl::Functions& gl = context.gl();
  const TextureLevel level = texture_level(context, {mesh.texture, mesh.level, mesh.layer}, argument);
  if (std::find(formats.begin(), formats.end(), level.format) == formats.end()) {
    fail(
        "{}: texture {} has format 0x{:04x}: expected GL_DEPTH_COMPONENT32F, 24 or 16, "
        "GL_DEPTH24_STENCIL8, GL_DEPTH32F_STENCIL8 or GL_R32F",
        argument.name(), mesh.texture, level.format);
  }
  check_within(level.size, {mesh.x, mesh.y}, size, argument);
  GLint mode = 0, swizzle = 0, base = 0, top = 0;
  gl.GetTextureParameteriv(mesh.texture, GL_DEPTH_STENCIL_TEXTURE_MODE, &mode);
  gl.GetTextureParameteriv(mesh.texture, GL_TEXTURE_SWIZZLE_R, &swizzle);
  gl.GetTextureParameteriv(mesh.texture, GL_TEXTURE_BASE_LEVEL, &base);
  gl.GetTextureParameteriv(mesh.texture, GL_TEXTURE_MAX_LEVEL, &top);
  if (mesh.layer < 0 && mode == GL_DEPTH_COMPONENT && swizzle == GL_RED && base == 0 && top >= mesh.level)
    return mesh.texture;
  if (!level.immutable)
    fail(
        "{}: texture {} is an array, or its GL_TEXTURE_SWIZZLE_R, BASE_LEVEL, MAX_LEVEL or "
        "GL_DEPTH_STENCIL_TEXTURE_MODE is unusual: expected storage by glTextureStorage2D or 3D",
        argument.name(), mesh.texture);
  views.push_back(std::make_unique<gl::Texture>(context, static_cast<GLenum>(level.format), mesh.texture,
                                                mesh.level, std::max(mesh.layer, 0)));
  return views.back()->id();
}

}  // namespace

void add_mesh_depth(gl::Context& context, const View& view, const Argument& argument, MeshDepths& depths) {
  const MeshDepth& mesh = *view.mesh_depth;
  const std::uint32_t texture = texture_of(context, mesh, argument, view.size, depths.views);
  render::MeshDepth read{.texture = texture,
                         .level = texture == mesh.texture ? mesh.level : 0,
                         .x = mesh.x,
                         .y = mesh.y,
                         .size = view.size};
  const double near = mesh.near_plane, far = mesh.far_plane;
  if (mesh.coding == DepthCoding::axis) {
    if (!(mesh.units_per_number > 0.0) || !std::isfinite(mesh.units_per_number))
      fail("{}: {} units per number: expected a number above zero", argument.name(), mesh.units_per_number);
    read.is_inverse = false;
    read.scale = static_cast<float>(mesh.units_per_number);
    read.nothing = 0.0f;
  } else if (mesh.coding != DepthCoding::planes) {
    fail("{}: coding {}: unknown value", argument.name(), static_cast<int>(mesh.coding));
  } else {
    check_planes(near, far, argument);
    // 1 / z is linear in d: 1 / near at d = 0, and 1 / far at d = 1.
    read.offset = static_cast<float>(1.0 / near);
    read.scale = static_cast<float>(1.0 / far - 1.0 / near);
    read.nothing = near < far ? 1.0f : 0.0f;
  }
  depths.list.push_back(read);
}

}  // namespace binosplat::library
