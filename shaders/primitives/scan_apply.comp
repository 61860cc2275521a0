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
  uint first = block * SCAN_BLOCK + gl_LocalInvocationIndex * SCAN_EACH;
  uint mine[SCAN_EACH];
  for (uint i = 0u; i < SCAN_EACH; ++i) mine[i] = first + i < count ? values[first + i] : 0u;
  scan_neighbours(block_sums[block], mine);
  for (uint i = 0u; i < SCAN_EACH; ++i) {
    if (first + i < count) values[first + i] = mine[i];
  }
}
