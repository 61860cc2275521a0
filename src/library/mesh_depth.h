#pragma once
// The caller's depth textures, as a frame reads them.

#include <binosplat/renderer.h>

#include <memory>
#include <vector>

#include "gl/texture.h"
#include "library/texture_level.h"
#include "render/mesh_depth.h"

namespace binosplat::library {

/// By view, and the layers of arrays, each as a texture.
struct MeshDepths {
  std::vector<render::MeshDepth> list;
  std::vector<std::unique_ptr<gl::Texture>> layers;
};

/// Appends a view's. Throws Error(bad_input) for a texture that cannot be read as MeshDepth says, or is
/// smaller than the view, and for planes that bound nothing.
void add_mesh_depth(gl::Context& context, const View& view, const Argument& argument, MeshDepths& depths);

}  // namespace binosplat::library
