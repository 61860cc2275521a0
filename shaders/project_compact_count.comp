// Stage 1, project, second part: counts the drawn Gaussians of each block of COMPACT_BLOCK.
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer DepthKeys { uvec4 depth_keys[]; };  // four at once: fewer, larger reads
layout(std430, binding = 1) writeonly buffer BlockCounts { uint block_counts[]; };
#include "frame.glsl"

shared uint seen;

void main() {
  uint block = group_index();
  if (block * COMPACT_BLOCK >= frame.gaussian_count) return;
  if (gl_LocalInvocationIndex == 0u) seen = 0u;
  barrier();
  uint mine = 0u;
  for (uint i = 0u; i < COMPACT_BLOCK / THREADS / 4; ++i) {
    uint at = block * COMPACT_BLOCK + 4u * (i * THREADS + gl_LocalInvocationIndex);
    uvec4 four = at < frame.gaussian_count ? depth_keys[at / 4u] : uvec4(DEPTH_KEY_NONE);
    for (uint k = 0u; k < 4u; ++k) mine += uint(at + k < frame.gaussian_count && four[k] != DEPTH_KEY_NONE);
  }
  atomicAdd(seen, mine);
  barrier();
  if (gl_LocalInvocationIndex == 0u) block_counts[block] = seen;
}
