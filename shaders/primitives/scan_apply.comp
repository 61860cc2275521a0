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

#define EACH (SCAN_BLOCK / THREADS)

void main() {
  uint count = amounts[amount].count;
  uint block = group_index();
  if (block * SCAN_BLOCK >= count) return;
  // Each invocation sums neighbours by itself, so that the group scans once.
  uint first = block * SCAN_BLOCK + gl_LocalInvocationIndex * EACH;
  uint mine[EACH];
  uint sum = 0u;
  for (uint i = 0u; i < EACH; ++i) {
    mine[i] = first + i < count ? values[first + i] : 0u;
    sum = saturating_add(sum, mine[i]);
  }
  uint before = saturating_add(block_sums[block], scan_group(sum));
  for (uint i = 0u; i < EACH; ++i) {
    if (first + i < count) values[first + i] = before;
    before = saturating_add(before, mine[i]);
  }
}
