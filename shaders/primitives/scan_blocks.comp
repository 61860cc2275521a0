// Scan, second: one group turns the blocks' sums into what comes before each block, and leaves the sum of all.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "shared/amount.glsl"
#include "shared/saturate.glsl"
#include "primitives/scan_block.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Amounts { Amount amounts[]; };
layout(std430, binding = 2) buffer BlockSums { uint block_sums[]; };
layout(std430, binding = 3) writeonly buffer Total { uint total[]; };
uniform uint amount;

void main() {
  uint blocks = blocks_of(amounts[amount].count, SCAN_BLOCK);
  uint before = 0u;
  for (uint start = 0u; start < blocks; start += SCAN_BLOCK) {
    uint first = start + gl_LocalInvocationIndex * SCAN_EACH;
    uint mine[SCAN_EACH];
    for (uint i = 0u; i < SCAN_EACH; ++i) mine[i] = first + i < blocks ? block_sums[first + i] : 0u;
    scan_neighbours(before, mine);
    for (uint i = 0u; i < SCAN_EACH; ++i) {
      if (first + i < blocks) block_sums[first + i] = mine[i];
    }
    before = saturating_add(before, group_total());
    barrier();  // group_total is read before the next round writes it
  }
  if (gl_LocalInvocationIndex == 0u) total[0] = before;
}
