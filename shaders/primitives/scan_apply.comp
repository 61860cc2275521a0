// Scan, third: each value becomes the sum of all values before it.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "shared/saturate.glsl"
#include "primitives/scan_block.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Amounts { Amount amounts[]; };
layout(std430, binding = 1) buffer Values { uint values[]; };
layout(std430, binding = 2) readonly buffer BlockSums { uint block_sums[]; };
uniform uint amount;

void main() {
  uint count = amounts[amount].count;
  uint block = group_index();
  if (block * SCAN_BLOCK >= count) return;
  uint before = block_sums[block];
  for (uint i = 0u; i < SCAN_BLOCK / THREADS; ++i) {
    uint at = block * SCAN_BLOCK + i * THREADS + gl_LocalInvocationIndex;
    uint sum = scan_group(at < count ? values[at] : 0u);
    if (at < count) values[at] = saturating_add(before, sum);
    before = saturating_add(before, group_total());
    barrier();  // group_total is read before the next round writes it
  }
}
