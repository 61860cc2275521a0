#if WITH_SUBGROUPS
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#endif
// Stage 1, project, last part: computes the splats of the Gaussians that project_cull.comp has selected, in index
// order. One invocation per Gaussian, for all views of the order group.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "projection.glsl"
#include "slots.glsl"
#include "tiles/tiles.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Views { View views[]; };  // (instance, view)
#include "gaussians.glsl"            // bindings 1 and 9
#include "threshold/threshold.glsl"  // binding 7
#include "sh.glsl"  // binding 2, of the page
#define SPLATS_WRITTEN
#include "splats.glsl"  // binding 12
layout(std430, binding = 3) readonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 4) readonly buffer Indices { uint indices[]; };          // Gaussian of each slot
layout(std430, binding = 6) writeonly buffer Coverages { uint coverages[]; };     // by splat: supertiles.glsl
#if MEASURES
layout(std430, binding = 8) writeonly buffer Measured { uint measured[]; };  // by splat
#endif
layout(std430, binding = 10) buffer FrameCounters { Counters counters; };
layout(std430, binding = 11) writeonly buffer Large { uint large[]; };  // splats for bin_large.comp, in any order
#if DISCS
layout(std430, binding = 5) writeonly buffer Discs { vec4 discs[]; };  // by splat: disc_of()
uniform uint is_flat;  // 1: the model has flat Gaussians (2D Gaussian Splatting)

// The plane of a flat Gaussian: 1/z is linear in the pixel, with slope xy, from 1/(.z) at the mean. w: the most by
// which z may differ from the mean's. 0 if the Gaussian is seen edge-on or is behind the eye.
vec4 disc_of(View view, Gaussian g, mat3 axes) {
  vec3 v = to_eye(view, g.position.xyz - view.anchor.xyz);
  mat3 eye = mat3(view.row_x.xyz, view.row_y.xyz, view.row_z.xyz) / view.eye.w;  // columns: the eye's axes
  vec3 n = scaled_axes(Gaussian(g.position, g.rotation, vec4(1.0)))[2] * eye;
  float facing = dot(n, v);
  if (is_flat == 0u || g.scale.z != 0.0 || v.z <= 0.0 || abs(facing) < float(EDGE_ON) * v.z) return vec4(0.0);
  return vec4(n.xy / (facing * view.lens.xy), v.z, 3.0 * length(onto_axes(view.row_z.xyz, axes)));
}
#endif
uniform uint view_begin;
uniform uint view_end;

// Appends a splat to `large` for bin_large.comp; one element serves both eyes if they share lists. All invocations must
// call it: a subgroup uses one atomic for all its splats, because all atomics wait for the same counter.
void append_large(uint splat, bool is_large) {
#if WITH_SUBGROUPS
  uint all = subgroupBallot(is_large).x, lane = gl_SubgroupInvocationID, place = 0u;
  if (all == 0u) return;
  if (lane == 0u) place = atomicAdd(counters.large_splats, uint(bitCount(all)));
  place = subgroupShuffle(place, 0u) + uint(bitCount(all & gl_SubgroupLtMask.x));
#else
  uint place = is_large ? atomicAdd(counters.large_splats, 1u) : 0u;
#endif
  if (!is_large) return;
  large[place] = splat;
  if (place % (LARGE_EACH * LARGE_ROW) != 0u) return;
  counters.large_x = LARGE_ROW;
  atomicMax(counters.large_y, place / (LARGE_EACH * LARGE_ROW) + 1u);
  counters.large_z = 1u;
}

void main() {
  uint slot = thread_index();
  uint end = instance_count * page_count;
  uint i = slot < arguments[0].count ? indices[slot] - page_first : end;  // before the page: wraps to a large i
  bool is_here = i < end;
  uvec2 place = place_in_page(is_here ? i : 0u);
  i = place.x;
  Gaussian g = GAUSSIAN(i);
  mat3 axes = scaled_axes(g);
#if SH_DEGREE == 0 && OFFSETS == 0
  vec3 colour = sh_colour(i, vec3(0.0));  // the same for every eye
#endif
#if LIST_VIEWS == 2
  uint first_eyes = 0u;  // coverage of the first eye's splat
#endif
  for (uint v = view_begin; v < view_end; ++v) {
    View view = views[place.y + v];
    uint splat_at = splat_of(slot, v);
#if OFFSETS > 0
    g = GAUSSIAN(place_of(i, v));
    axes = scaled_axes(g);
#endif
    Splat splat;
    uint coverage = 0u;
    if (is_here && is_kept(i, v) && project(view, g, axes, splat)) {
      splat.colour.w = tile_level(view, v, indices[slot], splat);
#if HALF
      splat = rounded(splat);  // the values that `bin` reads
#endif
      coverage = coverage_of(outline_of(splat, view), view);
    }
#if LIST_VIEWS == 2
    bool is_first = v % 2u == 0u;
    if (!is_first && (coverage == IN_MANY_SUPERTILES || first_eyes == IN_MANY_SUPERTILES)) {
      if (first_eyes != 0u) coverages[splat_at - frame.slots] = IN_MANY_SUPERTILES;
      if (coverage != 0u) coverage = IN_MANY_SUPERTILES;
      first_eyes = IN_MANY_SUPERTILES;
    }
    if (is_first) first_eyes = coverage;
    if (!is_first || v + 1u == view_end) append_large(is_first ? splat_at : splat_at - frame.slots, first_eyes == IN_MANY_SUPERTILES);
#else
    append_large(splat_at, coverage == IN_MANY_SUPERTILES);
#endif
    if (is_here) coverages[splat_at] = coverage;
#if MEASURES
    if (is_here) measured[splat_at] = 0u;
#endif
    if (coverage != 0u) {
#if SH_DEGREE == 0 && OFFSETS == 0
      splat.colour.rgb = colour;
#else
      splat.colour.rgb = sh_colour(place_of(i, v), normalize(g.position.xyz - view.anchor.xyz - view.eye.xyz));
#endif
    }
#if DISCS
    if (coverage != 0u) discs[splat_at] = disc_of(view, g, axes);
#endif
    write_splat(splat_at, coverage != 0u, splat);
  }
}
