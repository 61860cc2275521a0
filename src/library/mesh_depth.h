#pragma once
// Checks the caller's depth textures of meshes and converts them for a frame.

#include <binosplat/renderer.h>

#include <memory>
#include <vector>

#include "gl/texture.h"
#include "library/texture_level.h"
#include "render/mesh_depth.h"

namespace binosplat::library {

/// One mesh depth per view, and the texture views that shaders read instead of the textures. Keep them as
/// long as the list.
struct MeshDepths {
  std::vector<render::MeshDepth> list;
  std::vector<std::unique_ptr<gl::Texture>> views;
};

/// Appends a view's mesh depth. Throws Error(bad_input) for a texture that is smaller than the view or not as
/// MeshDepth requires, and for planes that enclose no range.
void add_mesh_depth(gl::Context& context, const View& view, const Argument& argument, MeshDepths& depths);

}  // namespace binosplat::library
