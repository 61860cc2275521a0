// Stage 3, pairs: how many pairs each Gaussian makes in the views of its order group, and what it touches there, in depth order.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "frame.glsl"
#include "lists.glsl"

layout(local_size_x = THREADS) in;

#if BOTH_EYES
#define TOUCHED uvec2  // of both eyes by one read
#else
#define TOUCHED uint
#endif

layout(std430, binding = 0) readonly buffer Amounts { Amount amounts[]; };
layout(std430, binding = 1) readonly buffer Order { uint order[]; };
layout(std430, binding = 2) readonly buffer Touched { TOUCHED touched_by[]; };  // (slot, view): lists.glsl
layout(std430, binding = 3) writeonly buffer PairOffsets { uint pair_offsets[]; };
layout(std430, binding = 4) writeonly buffer TouchedInOrder { TOUCHED touched_in_order[]; };  // (rank, view of the group)
#if !BOTH_EYES
uniform uint view_begin;
uniform uint view_end;
#endif

void main() {
  uint rank = thread_index();
  if (rank >= amounts[0].count) return;
#if BOTH_EYES
  TOUCHED both = touched_by[order[rank]];
  touched_in_order[rank] = both;
  pair_offsets[rank] = count_of(both.x) + count_of(both.y);
#else
  uint sum = 0u;
  for (uint v = view_begin; v < view_end; ++v) {
    uint touched = touched_by[order[rank] * frame.view_count + v];
    touched_in_order[rank * (view_end - view_begin) + v - view_begin] = touched;
    sum += count_of(touched);
  }
  pair_offsets[rank] = sum;
#endif
}
