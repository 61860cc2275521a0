#if WITH_SUBGROUPS
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#endif
// Stage 1, project, last part: computes the splats of the Gaussians that project_cull.comp has selected, in index
// order. One invocation per Gaussian, for all views of the order group.
#include "project_inputs.glsl"
#include "splat_places.glsl"

layout(local_size_x = THREADS) in;

#include "sh.glsl"  // binding 2, of the page
#include "splats_written.glsl"  // binding 12
layout(std430, binding = 3) readonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 4) readonly buffer Indices { uint indices[]; };          // Gaussian of each slot
layout(std430, binding = 6) writeonly buffer Coverages { uint coverages[]; };     // by splat: supertiles.glsl
layout(std430, binding = 10) buffer FrameCounters { Counters counters; };
layout(std430, binding = 11) writeonly buffer Large { uint large[]; };  // splats for bin_large.comp, in any order

#if MEASURES
layout(std430, binding = 8) writeonly buffer Measured { uint measured[]; };  // by splat
void clear_measured(uint splat) { measured[splat] = 0u; }
#else
void clear_measured(uint splat) {}
#endif

#if DISCS
#include "project_discs.glsl"  // binding 5
#else
void write_disc(uint splat, View view, Gaussian g, mat3 axes) {}
#endif

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
  // The number of groups doubles as it grows: a GPU takes up to 1.5 % of a frame for an atomic for each group, and
  // llvmpipe 0.05 ms for each group without splats.
  uint group = place / LARGE_EACH;
  if (place % LARGE_EACH != 0u || (group & group - 1u) != 0u && group % LARGE_ROW != 0u) return;
  atomicMax(counters.large_x, clamp(2u * group, 1u, LARGE_ROW));
  atomicMax(counters.large_y, group / LARGE_ROW + 1u);
  counters.large_z = 1u;
}

// Appends view v's splat to `large` if it is in many supertiles, and returns the coverage to store. All invocations
// must call it for each view in turn.
#if LIST_VIEWS == 2
uint first_eyes = 0u;  // coverage of the first eye's splat

uint append_if_large(uint splat, uint v, uint coverage) {
  bool is_first = v % 2u == 0u;
  uint first_splat = is_first ? splat : splat - frame.slots;
  if (!is_first && (coverage == IN_MANY_SUPERTILES || first_eyes == IN_MANY_SUPERTILES)) {
    if (first_eyes != 0u) coverages[first_splat] = IN_MANY_SUPERTILES;
    if (coverage != 0u) coverage = IN_MANY_SUPERTILES;
    first_eyes = IN_MANY_SUPERTILES;
  }
  if (is_first) first_eyes = coverage;
  if (!is_first || v + 1u == view_end) append_large(first_splat, first_eyes == IN_MANY_SUPERTILES);
  return coverage;
}
#else
uint append_if_large(uint splat, uint v, uint coverage) {
  append_large(splat, coverage == IN_MANY_SUPERTILES);
  return coverage;
}
#endif

void main() {
  uint slot = thread_index();
  uint end = instance_count * page_count;
  uint i = slot < arguments[0].count ? indices[slot] - page_first : end;  // before the page: wraps to a large i
  bool is_here = i < end;
  uvec2 place = place_in_page(is_here ? i : 0u);
  i = place.x;
  Gaussian g = GAUSSIAN(i);
  mat3 axes = scaled_axes(g);
  const bool one_colour = SH_DEGREE == 0 && OFFSETS == 0;  // for every eye
  vec3 colour = one_colour ? sh_colour(i, vec3(0.0)) : vec3(0.0);
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
      set_level(view, v, indices[slot], splat);
      coverage = coverage_of(outline_of(splat, view), view);
    }
    coverage = append_if_large(splat_at, v, coverage);
    if (is_here) coverages[splat_at] = coverage;
    if (is_here) clear_measured(splat_at);
    if (coverage != 0u) {
      vec3 away = g.position.xyz - view.anchor.xyz - view.eye.xyz;
      splat.colour.rgb = one_colour ? colour : sh_colour(place_of(i, v), normalize(away));
      write_disc(splat_at, view, g, axes);
    }
    write_splat(splat_at, coverage != 0u, splat);
  }
}
