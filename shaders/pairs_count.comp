// Stage 3, pairs: the pairs of each Gaussian in depth order, over the views of its order group.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Amounts { Amount amounts[]; };
layout(std430, binding = 1) readonly buffer Order { uint order[]; };
layout(std430, binding = 2) readonly buffer PairCounts { uint pair_counts[]; };
layout(std430, binding = 3) writeonly buffer PairOffsets { uint pair_offsets[]; };
uniform uint view_count;  // of the frame
uniform uint view_begin;
uniform uint view_end;

void main() {
  uint rank = thread_index();
  if (rank >= amounts[0].count) return;
  uint sum = 0u;
  for (uint v = view_begin; v < view_end; ++v) sum += pair_counts[order[rank] * view_count + v];
  pair_offsets[rank] = sum;
}
