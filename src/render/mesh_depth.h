#pragma once
// The depths of the caller's meshes in a view. Splats behind a mesh are not drawn.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "render/canvas.h"

namespace binosplat::render {

/// The texture with the depths of a view's meshes. `is_inverse`, `scale` and `offset` define how the
/// texture's number d becomes the depth z along the view's axis, in world units.
struct MeshDepth {
  std::uint32_t texture = 0;  // 2D
  int level = 0;
  int x = 0, y = 0;    // px, the lower left corner of the picture in the texture
  glm::ivec2 size{0};  // px, of the whole picture
  /// True: z = 1 / (scale d + offset). False: z = scale d.
  bool is_inverse = true;
  float scale = 1.0f, offset = 0.0f;
  float nothing = 1.0f;  // the d of a pixel without a mesh; with z = scale d, a d of at most 0 means the same
};

/// The shaders' struct; `whole` is the view's whole picture in px.
inline shared::MeshSource on_gpu(const MeshDepth& mesh, const glm::uvec2& whole) {
  return {.step = glm::vec2(mesh.size) / glm::vec2(whole),
          .left = static_cast<std::uint32_t>(mesh.x),
          .top = static_cast<std::uint32_t>(mesh.y + mesh.size.y - 1),
          .level = static_cast<std::uint32_t>(mesh.level),
          .is_inverse = mesh.is_inverse,
          .scale = mesh.scale,
          .offset = mesh.offset,
          .nothing = mesh.nothing};
}

/// The caller's textures that a frame reads and writes, by view. Each list is empty or has one element per
/// view, at most MAX_CANVASES.
struct CallersTextures {
  /// Destinations of the pictures. With mesh depths each is a 2D texture with one level, and the splats are
  /// blended over its colours.
  std::span<const Canvas> canvases = {};
  int depth_rows = 1;  // with canvases: 1 stores depths of every row, 2 of every second row
  std::span<const MeshDepth> mesh_depths = {};
};

}  // namespace binosplat::render
