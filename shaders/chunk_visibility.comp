// The visibility of a model's chunks in the views: sums the blend's results (MEASURE_VISIBILITY) over the Gaussians of
// each chunk. One invocation per slot of an order group; it skips Gaussians outside the page.
#include "shared/grid.glsl"
#include "splat_places.glsl"
#define OFFSETS 0          // no Scaffold-GS model has levels of detail
#include "gaussians.glsl"  // binding 1

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Views { View views[]; };
layout(std430, binding = 2) readonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 3) readonly buffer Indices { uint indices[]; };    // Gaussian of each slot
layout(std430, binding = 4) buffer Sums { uvec2 sums[]; };              // by splat: measure/visibility.glsl
layout(std430, binding = 5) readonly buffer Owners { uint owners[]; };      // chunk of each block of Gaussians
// For each view and chunk two sums of 64 bits: visibility, and visibility times (log2(distance from the eye) + 32).
layout(std430, binding = 6) buffer ChunkSums { uint chunk_sums[]; };
uniform uint chunk_count;
uniform uint block_size;  // Gaussians per block
uniform uint view_begin;
uniform uint view_end;

// The smallest visibility of a splat in the picture, even of a hidden one: that of 1/65,536 of a pixel.
const uint hidden = uint(VISIBILITY_SCALE) / 65536u;

void add(uint at, uvec2 number) {
  uint before = atomicAdd(chunk_sums[at], number.x);
  uint high = number.y + (before + number.x < before ? 1u : 0u);
  if (high != 0u) atomicAdd(chunk_sums[at + 1u], high);
}

void main() {
  uint slot = thread_index();
  if (slot >= arguments[0].count) return;
  uint i = indices[slot] - page_first;
  if (i >= page_count) return;
  uint chunk = owners[indices[slot] / block_size];
  for (uint v = view_begin; v < view_end; ++v) {
    uint from = splat_of(slot, v);
    uvec2 sum = sums[from];
    if (sum != uvec2(0)) sums[from] = uvec2(0);  // cleared for the next pass
    uint low = sum.x + (sum.y << VISIBILITY_LOW_BITS);
    uvec2 area = uvec2(low, (sum.y >> (32 - VISIBILITY_LOW_BITS)) + (low < sum.x ? 1u : 0u));
    if (area.y == 0u) area.x = max(area.x, hidden);
    uint at = 4u * (v * chunk_count + chunk);
    add(at, area);
    float away = distance(GAUSSIAN(i).position.xyz, views[v].anchor.xyz + views[v].eye.xyz);
    float weighted = (float(area.x) + 4294967296.0 * float(area.y)) * clamp(log2(away) + 32.0, 0.0, 64.0);
    float high = floor(weighted / 4294967296.0);
    add(at + 2u, uvec2(uint(weighted - 4294967296.0 * high), uint(high)));
  }
}
