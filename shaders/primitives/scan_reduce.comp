// Scan, first of two dispatches: the sum of each block of SCAN_BLOCK values (reduce, then scan: Sengupta 2007; no group
// waits for another, which GL does not promise to work).
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "shared/saturate.glsl"
#include "primitives/scan_block.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 1) readonly buffer Values { uvec4 values[]; };  // by four: fewer, larger reads
layout(std430, binding = 2) writeonly buffer BlockSums { uint block_sums[]; };
uniform uint which;  // of the arguments, those that say how many values there are

void main() {
  uint count = arguments[which].count;
  uint block = group_index();
  if (block * SCAN_BLOCK >= count) return;
  uint sum = 0u;
  for (uint i = 0u; i < SCAN_BLOCK / THREADS / 4; ++i) {
    uint at = block * SCAN_BLOCK + 4u * (i * THREADS + gl_LocalInvocationIndex);
    uvec4 four = at < count ? values[at / 4u] : uvec4(0u);
    for (uint k = 0u; k < 4u; ++k) sum = saturating_add(sum, at + k < count ? four[k] : 0u);
  }
  scan_group(sum);
  if (gl_LocalInvocationIndex == 0u) block_sums[block] = group_total();
}
