// Stage 1, project, first part: which Gaussians any view of an order group draws, told by their depth. One invocation a
// Gaussian of the model's page; what does not depend on the view is computed once.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "projection.glsl"
#include "tiles/tiles.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Views { View views[]; };
layout(std430, binding = 1) readonly buffer Gaussians { Gaussian gaussians[]; };  // of the page
layout(std430, binding = 2) writeonly buffer DepthKeys { uint depth_keys[]; };    // of the model
uniform uint page_first;
uniform uint page_count;
uniform uint view_begin;
uniform uint view_end;

void main() {
  uint i = thread_index();
  if (i >= page_count) return;
  Gaussian g = gaussians[i];
  mat3 axes = scaled_axes(g);
  uint key = DEPTH_KEY_NONE;
  for (uint v = view_begin; v < view_end && key == DEPTH_KEY_NONE; ++v) {
    Splat splat;
    // The views of an order group see the same depth.
    if (project(views[v], g, axes, splat) && touches_a_tile(splat, views[v])) key = floatBitsToUint(splat.depth);
  }
  depth_keys[page_first + i] = key;
}
