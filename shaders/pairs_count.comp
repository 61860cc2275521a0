// Stage 3, pairs: how many pairs each Gaussian makes in the views of its order group, and what it touches there, in depth order.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "lists.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Amounts { Amount amounts[]; };
layout(std430, binding = 1) readonly buffer Order { uint order[]; };
layout(std430, binding = 2) readonly buffer Touched { uint touched_by[]; };  // lists.glsl
layout(std430, binding = 3) writeonly buffer PairOffsets { uint pair_offsets[]; };
layout(std430, binding = 4) writeonly buffer TouchedInOrder { uint touched_in_order[]; };  // (rank, view of the group)
uniform uint view_count;  // of the frame
uniform uint view_begin;
uniform uint view_end;

void main() {
  uint rank = thread_index();
  if (rank >= amounts[0].count) return;
  uint first = order[rank] * view_count;
  uint sum = 0u;
  for (uint v = view_begin; v < view_end; v += 2u) {  // both eyes' at once, so that neither waits for the other
    uint one = touched_by[first + v];
    uint other = v + 1u < view_end ? touched_by[first + v + 1u] : 0u;
    sum += count_of(one) + count_of(other);
    uint to = rank * (view_end - view_begin) + v - view_begin;
    touched_in_order[to] = one;
    if (v + 1u < view_end) touched_in_order[to + 1u] = other;
  }
  pair_offsets[rank] = sum;
}
