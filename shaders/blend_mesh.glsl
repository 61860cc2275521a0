// The caller's meshes among the splats, MESH_DEPTH. Part of blending.glsl.
#ifndef MESH_DEPTH
#define MESH_DEPTH 0
#endif
#if MESH_DEPTH
#include "mesh_depths.glsl"
layout(std430, binding = 10) readonly buffer MeshDepths { float mesh_depths[]; };

float nearest_mesh, farthest_mesh;  // of the tile
uint mesh_place, mesh_row;          // of this invocation's first pixel; from a row of pixels to the next
uint place_of(View view, uint p);

float mesh_at(uint p) { return mesh_depths[mesh_place + p * mesh_row]; }

bool may_be_hidden(uint at[AHEAD]) {
  float deepest = batch_colour[at[0]].a;
  for (uint k = 1u; k < AHEAD; ++k) deepest = max(deepest, batch_colour[at[k]].a);
  return deepest > nearest_mesh;
}

// Whether all of the list from the batch's first splat on lies behind the meshes of the tile.
bool is_rest_hidden() { return batch_colour[0].a - frame.depth_slack > farthest_mesh; }
#endif

// Whether a splat lies behind the mesh in a pixel.
bool is_hidden(uint at, uint p) {
#if MESH_DEPTH
  return batch_colour[at].a > mesh_at(p);
#else
  return false;
#endif
}

// The depth of the mesh in a pixel; 0: there is none.
float mesh_behind(uint p) {
#if MESH_DEPTH
  float depth = nearest_mesh < NO_MESH ? mesh_at(p) : NO_MESH;
  return depth < NO_MESH ? depth : 0.0;
#else
  return 0.0;
#endif
}

void begin_mesh(View view, uint tile) {
#if MESH_DEPTH
  nearest_mesh = mesh_depths[2u * tile];
  farthest_mesh = mesh_depths[2u * tile + 1u];
  mesh_row = pixel_row(view);
  mesh_place = 2u * frame.tile_count + place_of(view, 0u);
#endif
}
