// How far each pixel of a view is seen, where the caller's meshes stand in it: a work group a tile, an invocation a pixel. What
// the blend compares splats' depths with: z, with the tangent projection the distance of what is seen there.
//   ARRAY   1: the caller's texture is an array
#include "shared/axes.h"
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "supertiles.glsl"
#include "tiles/places.glsl"
#include "tiles/pixel_places.glsl"
#include "mesh_depths.glsl"

layout(local_size_x = TILE_SIZE, local_size_y = TILE_SIZE) in;

layout(std430, binding = 0) readonly buffer Views { View views[]; };
layout(std430, binding = 10) writeonly buffer MeshDepths { float mesh_depths[]; };
#if ARRAY
layout(binding = MAX_CANVASES) uniform sampler2DArray depths;
#else
layout(binding = MAX_CANVASES) uniform sampler2D depths;
#endif
#include "frame.glsl"
uniform uint view_index;
uniform uint view_tiles;                 // of the view
uniform uint whole_width, whole_height;  // px, of the view's whole picture
uniform uint left, bottom;               // px, where that begins in the texture,
uniform uint columns, rows;              // and how large it is there
uniform uint level, layer;
uniform uint is_inverse;                 // 1: z = 1 / (scale d + offset), d being the texture's number; 0: z = scale d
uniform uint scale, offset, nothing;     // bits of floats; d of pixels without a mesh

shared uint any_mesh;           // 1: there is one in the tile
shared uint nearest, farthest;  // bits of floats: of the tile's pixels

float depth_at(uvec2 pixel, View view) {
  uvec2 at = (2u * pixel + 1u) * uvec2(columns, rows) / (2u * uvec2(whole_width, whole_height));
  ivec2 texel = ivec2(left + at.x, bottom + rows - 1u - at.y);
#if ARRAY
  float d = texelFetch(depths, ivec3(texel, layer), int(level)).r;
#else
  float d = texelFetch(depths, texel, int(level)).r;
#endif
  if (d == uintBitsToFloat(nothing) || (is_inverse == 0u && !(d > 0.0))) return NO_MESH;
  precise float z = uintBitsToFloat(scale) * d;
  if (is_inverse != 0u) {
    precise float inverse = z + uintBitsToFloat(offset);
    if (!(inverse > 0.0)) return NO_MESH;
    z = 1.0 / inverse;
  }
#if PROJECTION == PROJECTION_TANGENT
  precise vec2 ray = (vec2(pixel) + 0.5 - view.lens.zw) / view.lens.xy;
  precise float distance = z * sqrt(fma(ray.y, ray.y, fma(ray.x, ray.x, 1.0)));
  z = distance;
#endif
  return z < NO_MESH ? z : NO_MESH;  // not a number: none
}

void main() {
  if (group_index() >= view_tiles) return;
  View view = views[view_index];
  uint tile = view.supertile_offset * SUPERTILE_TILES + group_index();
  bool is_first = gl_LocalInvocationIndex == 0u;
  if (is_first) {
    any_mesh = farthest = 0u;
    nearest = floatBitsToUint(NO_MESH);
  }
  barrier();
  uvec2 pixel = tile_corner(tile_of(tile, view), view) + gl_LocalInvocationID.xy;
  bool inside = all(lessThanEqual(pixel, last_drawn(view)));
  float depth = inside ? depth_at(pixel, view) : NO_MESH;
  if (depth < NO_MESH) any_mesh = 1u;
  barrier();
  if (any_mesh != 0u) {
    if (inside) mesh_depths[2u * frame.tile_count + pixel_place(view, tile, pixel)] = depth;
    if (inside) atomicMin(nearest, floatBitsToUint(depth));
    if (inside) atomicMax(farthest, floatBitsToUint(depth));
    barrier();
  }
  if (!is_first) return;
  mesh_depths[2u * tile] = uintBitsToFloat(nearest);
  mesh_depths[2u * tile + 1u] = any_mesh != 0u ? uintBitsToFloat(farthest) : NO_MESH;
}
