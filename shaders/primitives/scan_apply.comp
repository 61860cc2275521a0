// Scan, second: each value becomes the sum of all values before it. By four, since what a store does not fill of 32 bytes costs as
// much.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "shared/arguments.glsl"
#include "shared/saturate.glsl"
#include "primitives/scan_block.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 1) buffer Values { uvec4 values[]; };  // those beyond the last become anything
layout(std430, binding = 2) readonly buffer BlockSums { uint block_sums[]; };
layout(std430, binding = 3) writeonly buffer Total { uint total[]; };
uniform uint which;

void main() {
  uint count = arguments[which].count;
  uint block = group_index();
  uint blocks = max(1u, blocks_of(count, SCAN_BLOCK));
  if (block >= blocks) return;
  // Each group sums up the blocks before its own: for a few thousand of them cheaper than a dispatch that scans their sums.
  uint before = 0u;
  for (uint i = gl_LocalInvocationIndex; i < block; i += THREADS) before = saturating_add(before, block_sums[i]);
  scan_group(before);
  before = take_group_total();
  uint first = block * SCAN_BLOCK + gl_LocalInvocationIndex * SCAN_EACH;
  uint mine[SCAN_EACH];
  for (uint i = 0u; i < SCAN_EACH; i += 4u) {
    uvec4 four = first + i < count ? values[(first + i) / 4u] : uvec4(0u);
    for (uint k = 0u; k < 4u; ++k) mine[i + k] = first + i + k < count ? four[k] : 0u;
  }
  scan_neighbours(before, mine);
  if (block + 1u == blocks && gl_LocalInvocationIndex == 0u) total[0] = saturating_add(before, group_total());
  for (uint i = 0u; i < SCAN_EACH; i += 4u) {
    if (first + i < count) values[(first + i) / 4u] = uvec4(mine[i], mine[i + 1u], mine[i + 2u], mine[i + 3u]);
  }
}
