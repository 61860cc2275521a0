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
  for (uint start = 0u; start < blocks; start += THREADS) {
    uint at = start + gl_LocalInvocationIndex;
    uint sum = scan_group(at < blocks ? block_sums[at] : 0u);
    if (at < blocks) block_sums[at] = saturating_add(before, sum);
    before = saturating_add(before, group_total());
    barrier();  // group_total is read before the next round writes it
  }
  if (gl_LocalInvocationIndex == 0u) total[0] = before;
}
