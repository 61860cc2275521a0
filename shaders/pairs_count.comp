// Stage 3, pairs: how many pairs each Gaussian makes in the views of its order group, and what it touches there, in depth order.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "frame.glsl"
#include "supertiles.glsl"

layout(local_size_x = THREADS) in;

#if BOTH_EYES
#define COVERAGE uvec2  // of both eyes by one read
#else
#define COVERAGE uint
#endif

layout(std430, binding = 0) readonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 1) readonly buffer Order { uint order[]; };
layout(std430, binding = 2) readonly buffer Coverages { COVERAGE coverages[]; };  // (slot, view): supertiles.glsl
layout(std430, binding = 3) writeonly buffer PairOffsets { uint pair_offsets[]; };
layout(std430, binding = 4) writeonly buffer CoverageInOrder { COVERAGE coverage_in_order[]; };  // (rank, view of the group)
#if !BOTH_EYES
uniform uint view_begin;
uniform uint view_end;
#endif

void main() {
  uint rank = thread_index();
  if (rank >= arguments[0].count) return;
#if BOTH_EYES
  COVERAGE both = coverages[order[rank]];
  coverage_in_order[rank] = both;
  pair_offsets[rank] = count_of(both.x) + count_of(both.y);
#else
  uint sum = 0u;
  for (uint v = view_begin; v < view_end; ++v) {
    uint coverage = coverages[order[rank] * frame.view_count + v];
    coverage_in_order[rank * (view_end - view_begin) + v - view_begin] = coverage;
    sum += count_of(coverage);
  }
  pair_offsets[rank] = sum;
#endif
}
