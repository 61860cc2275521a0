#pragma once
// The caller's depth textures, as a frame reads them.

#include <binosplat/renderer.h>

#include "gl/context.h"
#include "render/mesh_depth.h"

namespace binosplat::library {

/// Throws Error(bad_input) for a texture that cannot be read as MeshDepth says, or is smaller than the view,
/// and for planes that bound nothing.
render::MeshDepth mesh_depth_of(const gl::Context& context, const View& view);

}  // namespace binosplat::library
