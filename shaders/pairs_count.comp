#if LOOKS_BACK
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#endif
#pragma optionNV(unroll all)
// Stage 3, pairs: how many pairs each Gaussian makes in the views of its order group, and what it touches there, in depth order.
//   LOOKS_BACK    1: where each one's pairs begin, in this one dispatch, whose last group leaves the arguments of later ones; 0: a
//                 scan comes next
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "frame.glsl"
#include "supertiles.glsl"

#if BOTH_EYES
#define COVERAGE uvec2  // of both eyes by one read
#else
#define COVERAGE uint
#endif

layout(std430, binding = 0) readonly buffer OrderArguments { DispatchArguments order_arguments[]; };
layout(std430, binding = 1) readonly buffer Order { uint order[]; };
layout(std430, binding = 2) readonly buffer Coverages { COVERAGE coverages[]; };  // (slot, view): supertiles.glsl
layout(std430, binding = 4) writeonly buffer CoverageInOrder { COVERAGE coverage_in_order[]; };  // (rank, view of the group)
#if !BOTH_EYES
uniform uint view_begin;
uniform uint view_end;
#endif

// The pairs of the Gaussian of this rank.
uint count_pairs(uint rank) {
#if BOTH_EYES
  COVERAGE both = coverages[order[rank]];
  coverage_in_order[rank] = both;
  return count_of(both.x) + count_of(both.y);
#else
  uint sum = 0u;
  for (uint v = view_begin; v < view_end; ++v) {
    uint coverage = coverages[order[rank] * frame.view_count + v];
    coverage_in_order[rank * (view_end - view_begin) + v - view_begin] = coverage;
    sum += count_of(coverage);
  }
  return sum;
#endif
}

layout(local_size_x = THREADS) in;

#if LOOKS_BACK
layout(std430, binding = 3) writeonly buffer PairOffsets { uvec4 pair_offsets[]; };  // those beyond the last become anything
layout(std430, binding = 5) writeonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 6) buffer FrameCounters { Counters counters; };
#define LOOK_BACK_BINDING 7
#include "primitives/look_back.glsl"
#include "count_arguments.glsl"
#define WITH_SUBGROUPS 1
#include "primitives/scan_block.glsl"

shared uint counts[SCAN_BLOCK];

void main() {
  uint count = order_arguments[0].count;
  uint groups = max(1u, blocks_of(count, SCAN_BLOCK));
  if (group_index() >= groups) return;
  uint group = take_number();
  uint self = gl_LocalInvocationIndex, first = group * SCAN_BLOCK;
  for (uint i = self; i < SCAN_BLOCK; i += THREADS) counts[i] = first + i < count ? count_pairs(first + i) : 0u;
  memoryBarrierShared();
  barrier();
  uint mine[SCAN_EACH];
  for (uint k = 0u; k < SCAN_EACH; ++k) mine[k] = counts[self * SCAN_EACH + k];
  scan_neighbours(0u, mine);
  uint own = take_group_total();
  uint before = sum_before(group, groups, own);
  if (group + 1u == groups && self == 0u)
    set_arguments(before == LOOK_BACK_MOST ? COUNT_MAX : saturating_add(before, own));
  first += self * SCAN_EACH;
  for (uint k = 0u; k < SCAN_EACH; k += 4u) {
    if (first + k < count) pair_offsets[(first + k) / 4u] = before + uvec4(mine[k], mine[k + 1u], mine[k + 2u], mine[k + 3u]);
  }
}
#else
layout(std430, binding = 3) writeonly buffer PairOffsets { uint pair_offsets[]; };

void main() {
  uint rank = thread_index();
  if (rank < order_arguments[0].count) pair_offsets[rank] = count_pairs(rank);
}
#endif
