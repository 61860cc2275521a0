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

#define EACH 8u

void main() {
  uint blocks = blocks_of(amounts[amount].count, SCAN_BLOCK);
  uint before = 0u;
  for (uint start = 0u; start < blocks; start += THREADS * EACH) {
    uint first = start + gl_LocalInvocationIndex * EACH;
    uint mine[EACH];
    uint sum = 0u;
    for (uint i = 0u; i < EACH; ++i) {
      mine[i] = first + i < blocks ? block_sums[first + i] : 0u;
      sum = saturating_add(sum, mine[i]);
    }
    uint mine_before = saturating_add(before, scan_group(sum));
    for (uint i = 0u; i < EACH; ++i) {
      if (first + i < blocks) block_sums[first + i] = mine_before;
      mine_before = saturating_add(mine_before, mine[i]);
    }
    before = saturating_add(before, group_total());
    barrier();  // group_total is read before the next round writes it
  }
  if (gl_LocalInvocationIndex == 0u) total[0] = before;
}
