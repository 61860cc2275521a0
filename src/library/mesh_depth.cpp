#include "library/mesh_depth.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"

namespace binosplat::library {

namespace {

constexpr std::array formats = {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT16,
                                GL_DEPTH24_STENCIL8,   GL_DEPTH32F_STENCIL8, GL_R32F};

/// The texture, or a view of its layer.
std::uint32_t texture_of(gl::Context& context, const MeshDepth& mesh, const glm::ivec2& size,
                         std::vector<std::unique_ptr<gl::Texture>>& layers_seen) {
  const gl::Functions& gl = context.gl();
  GLint kind = 0;
  gl.GetTextureParameteriv(mesh.texture, GL_TEXTURE_TARGET, &kind);
  if (gl.GetError() != GL_NO_ERROR) fail("mesh depth: there is no texture {}", mesh.texture);
  const bool is_array = kind == GL_TEXTURE_2D_ARRAY;
  if (kind != GL_TEXTURE_2D && !is_array)
    fail("mesh depth: texture {} is neither 2D nor an array of such, or has samples: resolve it into one",
         mesh.texture);
  const auto number = [&](GLenum what) {
    GLint value = 0;
    gl.GetTextureLevelParameteriv(mesh.texture, mesh.level, what, &value);
    return value;
  };
  const glm::ivec2 has(number(GL_TEXTURE_WIDTH), number(GL_TEXTURE_HEIGHT));
  if (gl.GetError() != GL_NO_ERROR || has.x == 0)
    fail("mesh depth: texture {} has no level {}", mesh.texture, mesh.level);
  const int layers = number(GL_TEXTURE_DEPTH);
  if (is_array ? mesh.layer < 0 || mesh.layer >= layers : mesh.layer >= 0) {
    fail("mesh depth: texture {} has no layer {}: it {}", mesh.texture, mesh.layer,
         is_array ? fmt::format("is an array of {}", layers) : "is no array");
  }
  const GLint format = number(GL_TEXTURE_INTERNAL_FORMAT);
  if (std::find(formats.begin(), formats.end(), format) == formats.end()) {
    fail(
        "mesh depth: texture {} has format 0x{:04x}: expected GL_DEPTH_COMPONENT32F, 24 or 16, "
        "GL_DEPTH24_STENCIL8, GL_DEPTH32F_STENCIL8 or GL_R32F",
        mesh.texture, format);
  }
  GLint reads = GL_DEPTH_COMPONENT;
  gl.GetTextureParameteriv(mesh.texture, GL_DEPTH_STENCIL_TEXTURE_MODE, &reads);
  if (reads != GL_DEPTH_COMPONENT)
    fail(
        "mesh depth: texture {} gives its stencil (GL_DEPTH_STENCIL_TEXTURE_MODE): set it to "
        "GL_DEPTH_COMPONENT",
        mesh.texture);
  if (mesh.x < 0 || mesh.y < 0 || size.x > has.x - mesh.x || size.y > has.y - mesh.y) {
    fail("mesh depth: a view of {} x {} px at {}, {} does not lie within texture {} of {} x {}", size.x,
         size.y, mesh.x, mesh.y, mesh.texture, has.x, has.y);
  }
  if (!is_array) return mesh.texture;
  GLint immutable = 0;
  gl.GetTextureParameteriv(mesh.texture, GL_TEXTURE_IMMUTABLE_FORMAT, &immutable);
  if (immutable == 0)
    fail("mesh depth: array {} has no immutable storage: make it by glTextureStorage3D", mesh.texture);
  layers_seen.push_back(std::make_unique<gl::Texture>(context, static_cast<GLenum>(format), mesh.texture,
                                                      mesh.level, mesh.layer));
  return layers_seen.back()->id();
}

}  // namespace

void add_mesh_depth(gl::Context& context, const View& view, MeshDepths& depths) {
  const MeshDepth& mesh = *view.mesh_depth;
  render::MeshDepth read{.texture = texture_of(context, mesh, view.size, depths.layers),
                         .level = mesh.layer < 0 ? mesh.level : 0,
                         .x = mesh.x,
                         .y = mesh.y,
                         .size = view.size};
  const double near = mesh.near_plane, far = mesh.far_plane;
  if (mesh.coding == DepthCoding::axis) {
    if (!(mesh.units_per_number > 0.0) || !std::isfinite(mesh.units_per_number))
      fail("mesh depth: {} units per number: expected a number above zero", mesh.units_per_number);
    read.is_inverse = false;
    read.scale = static_cast<float>(mesh.units_per_number);
    read.nothing = 0.0f;
  } else if (near > 0.0 && far > 0.0 && near != far) {
    // 1 / z is 1 / near where d is 0, and 1 / far where d is 1, and linear between.
    read.offset = static_cast<float>(1.0 / near);
    read.scale = static_cast<float>(1.0 / far - 1.0 / near);
    read.nothing = near < far ? 1.0f : 0.0f;
  } else {
    fail("mesh depth: planes at {} and {}: expected two distances above zero, one of which may be infinite",
         near, far);
  }
  depths.list.push_back(read);
}

}  // namespace binosplat::library
