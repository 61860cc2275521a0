// After the blend: stores max(T) of each drawn Gaussian for the next frame's Th. One invocation per slot of an order
// group. project_cull.comp has written the values of all other Gaussians.
#include "shared/grid.glsl"
#include "splat_places.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 1) readonly buffer Indices { uint indices[]; };      // Gaussian of each slot
layout(std430, binding = 2) readonly buffer Coverages { uint coverages[]; };  // by splat: supertiles.glsl
layout(std430, binding = 3) readonly buffer Measured { uint measured[]; };    // by splat
layout(std430, binding = 4) writeonly buffer NextBounds { float next_bounds[]; };  // (view, Gaussian)
uniform uint view_begin;
uniform uint view_end;  // without the probe

void main() {
  uint slot = thread_index();
  if (slot >= arguments[0].count) return;
  for (uint v = view_begin; v < view_end; ++v) {
    if (coverages[splat_of(slot, v)] == 0u) continue;
    float most = uintBitsToFloat(measured[splat_of(slot, v)]);
    next_bounds[v * frame.gaussian_count + indices[slot]] = clamp(most, float(BOUND_FLOOR), 1.0);
  }
}
