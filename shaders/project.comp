// Stage 1, project, last part: the splats of the Gaussians that cull.comp found, side by side in index order. One invocation
// a Gaussian and eye.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "projection.glsl"
#include "tiles/tiles.glsl"

layout(local_size_x = THREADS, local_size_y = EYES) in;

layout(std430, binding = 0) readonly buffer Views { View views[]; };
#include "gaussians.glsl"            // bindings 1 and 9
#include "threshold/threshold.glsl"  // binding 7
#include "sh.glsl"  // binding 2, of the page
layout(std430, binding = 3) readonly buffer Amounts { Amount amounts[]; };
layout(std430, binding = 4) readonly buffer Indices { uint indices[]; };          // Gaussian of each slot
layout(std430, binding = 5) writeonly buffer Splats { Splat splats[]; };          // (view, slot)
layout(std430, binding = 6) writeonly buffer TileCounts { uint tile_counts[]; };  // (view, slot)
#if RECORDS || WEIGHS
layout(std430, binding = 8) writeonly buffer Measured { uint measured[]; };  // (view, slot), of one word or two
#endif
layout(std430, binding = 10) buffer FrameCounters { Counters counters; };
layout(std430, binding = 11) writeonly buffer Tall { uint tall[]; };  // splats for count_tall.comp, in any order
uniform uint view_begin;
uniform uint view_end;
uniform uint slots;  // of one view

void leave_aside(uint splat) {
  uint place = atomicAdd(counters.tall, 1u);
  tall[place] = splat;
  counters.tall_x = TALL_ROW;
  if (place % (TALL_EACH * TALL_ROW) == 0u) atomicMax(counters.tall_y, place / (TALL_EACH * TALL_ROW) + 1u);
  counters.tall_z = 1u;
}

void main() {
  uint slot = thread_index();
  if (slot >= amounts[0].count) return;
  uint i = indices[slot] - page_first;  // wraps, and is too large, before the page
  if (i >= page_count) return;
  Gaussian g = gaussians[i];
  mat3 axes = scaled_axes(g);
  for (uint v = view_begin + gl_LocalInvocationID.y; v < view_end; v += EYES) {
    View view = views[v];
#if OFFSETS > 0
    g = gaussians[place_of(i, v)];
    axes = scaled_axes(g);
#endif
    Splat splat;
    uint tiles = 0u;
    if (is_kept(i, v) && project(view, g, axes, splat)) {
      splat.colour.w = tile_level(v, indices[slot], g, axes, splat);
      uvec4 box = tile_box(splat, view);
      bool is_tall = box.w - box.y > TALL_ROWS;
      tiles = is_tall ? 1u : tile_count(splat, view, box);  // not known yet
      if (is_tall) leave_aside(v * slots + slot);
    }
    tile_counts[v * slots + slot] = tiles;
#if WEIGHS
    measured[2u * (v * slots + slot)] = 0u;
    measured[2u * (v * slots + slot) + 1u] = 0u;
#elif RECORDS
    measured[v * slots + slot] = 0u;
#endif
    if (tiles > 0u) {
      splat.colour.rgb = sh_colour(place_of(i, v), normalize(g.position.xyz - view.anchor.xyz - view.eye.xyz));
      splats[v * slots + slot] = splat;
    }
  }
}
