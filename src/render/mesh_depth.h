#pragma once
// Meshes among the splats: the depths of what the caller has drawn in a view already. What lies behind them
// is not drawn.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "render/canvas.h"

namespace binosplat::render {

/// Where the depths of a view's meshes are, and how a number d of the texture tells the depth z along the
/// view's axis, in world units.
struct MeshDepth {
  std::uint32_t texture = 0;  // 2D
  int level = 0;
  int x = 0, y = 0;    // px, lower left corner of the picture in it
  glm::ivec2 size{0};  // px, of the whole picture in it
  /// z = 1 / (scale d + offset), or z = scale d.
  bool is_inverse = true;
  float scale = 1.0f, offset = 0.0f;
  float nothing = 1.0f;  // the d of pixels without a mesh; with z = scale d those at 0, too
};

/// As shaders read it, for a view whose whole picture is so large.
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

/// Textures of the caller's that a frame reads and writes, by view; none of a kind, or one for each view, at
/// most MAX_CANVASES.
struct CallersTextures {
  /// Where the pictures go. With mesh depths each is a 2D texture with one level, over
  /// whose colours the splats are blended.
  std::span<const Canvas> canvases = {};
  int depth_rows = 1;  // with canvases: depths are wanted in every row, or every second one
  std::span<const MeshDepth> mesh_depths = {};
};

}  // namespace binosplat::render
