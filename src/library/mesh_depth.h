#pragma once
// Checks the caller's depth textures of meshes and converts them for a frame.

#include <binosplat/renderer.h>

#include <memory>
#include <vector>

#include "gl/texture.h"
#include "library/texture_level.h"
#include "render/mesh_depth.h"

namespace binosplat::library {

/// One depth per view, and a texture view of each layer of an array, which must live as long.
struct MeshDepths {
  std::vector<render::MeshDepth> list;
  std::vector<std::unique_ptr<gl::Texture>> layers;
};

/// Appends a view's mesh depth. Throws Error(bad_input) for a texture that is smaller than the view or not as
/// MeshDepth requires, and for planes that bound nothing.
void add_mesh_depth(gl::Context& context, const View& view, const Argument& argument, MeshDepths& depths);

}  // namespace binosplat::library
