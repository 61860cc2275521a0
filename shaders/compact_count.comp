// Stage 1, project, second part: how many Gaussians of each block of COMPACT_BLOCK are drawn.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer DepthKeys { uint depth_keys[]; };
layout(std430, binding = 1) writeonly buffer BlockCounts { uint block_counts[]; };
uniform uint gaussian_count;

shared uint seen;

void main() {
  uint block = group_index();
  if (block * COMPACT_BLOCK >= gaussian_count) return;
  if (gl_LocalInvocationIndex == 0u) seen = 0u;
  barrier();
  uint mine = 0u;
  for (uint i = 0u; i < COMPACT_BLOCK / THREADS; ++i) {
    uint at = block * COMPACT_BLOCK + i * THREADS + gl_LocalInvocationIndex;
    if (at < gaussian_count) mine += uint(depth_keys[at] != DEPTH_KEY_NONE);
  }
  atomicAdd(seen, mine);
  barrier();
  if (gl_LocalInvocationIndex == 0u) block_counts[block] = seen;
}
