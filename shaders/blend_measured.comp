// After the blend: what it measured of each Gaussian drawn, for the next frame's Th, and how far they are. One invocation a slot of
// an order group. What was not drawn was written by project_cull.comp.
#include "shared/axes.h"
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "slots.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 5) readonly buffer Depths { uint depths[]; };  // (order group, slot): slots.glsl
layout(std430, binding = 6) buffer FrameCounters { Counters counters; };
uniform uint order_group;
#if MEASURES
layout(std430, binding = 1) readonly buffer Indices { uint indices[]; };      // Gaussian of each slot
layout(std430, binding = 2) readonly buffer Coverages { uint coverages[]; };  // by splat: supertiles.glsl
layout(std430, binding = 3) readonly buffer Measured { uint measured[]; };    // by splat
layout(std430, binding = 4) writeonly buffer NextBounds { float next_bounds[]; };  // (view, Gaussian)
uniform uint view_begin;
uniform uint view_end;  // without the probe
#endif

shared uint depth_sum;

void main() {
  uint slot = thread_index(), self = gl_LocalInvocationIndex;
  bool is_one = slot < arguments[0].count;
  if (self == 0u) depth_sum = 0u;
  barrier();
  if (is_one) atomicAdd(depth_sum, depths[order_group * frame.slots + slot] / THREADS);
  barrier();
  if (self == 0u) {
    uint before = atomicAdd(counters.depths_low, depth_sum);
    if (before + depth_sum < before) atomicAdd(counters.depths_high, 1u);
  }
#if MEASURES
  if (!is_one) return;
  for (uint v = view_begin; v < view_end; ++v) {
    if (coverages[splat_of(slot, v)] == 0u) continue;
    float most = uintBitsToFloat(measured[splat_of(slot, v)]);
    next_bounds[v * frame.gaussian_count + indices[slot]] = clamp(most, float(BOUND_FLOOR), 1.0);
  }
#endif
}
