#if LOOKS_BACK
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#endif
// Stage 1, project, second part: gives the drawn Gaussians slots without gaps, in index order, because slots break ties
// of depth. The last block writes later dispatches' arguments. Also sums sort keys, for the middle depth (method.md 5).
//   LOOKS_BACK    1: blocks count and compact in this dispatch; 0: project_compact_count.comp has counted the blocks
#include "shared/types.h"
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) writeonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 1) readonly buffer DepthKeys { uint depth_keys[]; };
layout(std430, binding = 3) writeonly buffer Depths { uint depths[]; };    // (order group, slot): splat_places.glsl
layout(std430, binding = 4) writeonly buffer Indices { uint indices[]; };  // Gaussian of each slot
layout(std430, binding = 5) buffer FrameCounters { Counters counters; };
#include "frame.glsl"
#include "count_arguments.glsl"
uniform uint order_group;
#if LOOKS_BACK
#define LOOK_BACK_BINDING 2
#include "look_back.glsl"
#else
layout(std430, binding = 2) readonly buffer BlockCounts { uint block_counts[]; };
shared uint sum_of_blocks;

// Each block sums the counts of earlier blocks: with some thousands of blocks, this is faster than a separate scan.
uint sum_before(uint block, uint blocks, uint own) {
  if (gl_LocalInvocationIndex == 0u) sum_of_blocks = 0u;
  barrier();
  uint sum = 0u;
  for (uint b = gl_LocalInvocationIndex; b < block; b += THREADS) sum += block_counts[b];
  atomicAdd(sum_of_blocks, sum);
  barrier();
  return sum_of_blocks;
}
#endif

#define EACH (COMPACT_BLOCK / THREADS)
#define WORDS (THREADS / 32)
shared uint masks[EACH][WORDS];  // by round: a bit for each Gaussian that is drawn
shared uint depth_sum;

void main() {
  uint blocks = max(1u, blocks_of(frame.gaussian_count, COMPACT_BLOCK));
  uint block = group_index();
  if (block >= blocks) return;
#if LOOKS_BACK
  block = take_number();
#endif
  uint self = gl_LocalInvocationIndex;
  uint key[EACH], own_sum = 0u;
  for (uint i = 0u; i < EACH; ++i) {
    uint at = block * COMPACT_BLOCK + i * THREADS + self;
    key[i] = at < frame.gaussian_count ? depth_keys[at] : DEPTH_KEY_NONE;
    if (key[i] != DEPTH_KEY_NONE) own_sum += key[i] / COMPACT_BLOCK;
  }
  if (self < EACH * WORDS) masks[self / WORDS][self % WORDS] = 0u;
  if (self == 0u) depth_sum = 0u;
  barrier();
#if LOOKS_BACK
  own_sum = subgroupAdd(own_sum);
  if (gl_SubgroupInvocationID == 0u)
#endif
  atomicAdd(depth_sum, own_sum);
  uint place[EACH];  // index among the drawn Gaussians of the block
  uint seen = 0u;
  for (uint i = 0u; i < EACH; ++i) {
    bool is_drawn = key[i] != DEPTH_KEY_NONE;
    if (is_drawn) atomicOr(masks[i][self / 32u], 1u << (self % 32u));
    barrier();
    place[i] = seen + uint(bitCount(masks[i][self / 32u] & ((1u << (self % 32u)) - 1u)));
    for (uint w = 0u; w < WORDS; ++w) {
      uint of_word = uint(bitCount(masks[i][w]));
      if (w < self / 32u) place[i] += of_word;
      seen += of_word;
    }
  }
  uint before = sum_before(block, blocks, seen);
  if (block + 1u == blocks && self == 0u) set_arguments(before + seen);
  if (self == 0u && seen != 0u) {
    uint low = atomicAdd(counters.depths_low, depth_sum);
    if (low + depth_sum < low) atomicAdd(counters.depths_high, 1u);
  }
  for (uint i = 0u; i < EACH; ++i) {
    uint to = before + place[i];
    if (key[i] == DEPTH_KEY_NONE || to >= capacity) continue;
    depths[order_group * frame.slots + to] = key[i];
    indices[to] = block * COMPACT_BLOCK + i * THREADS + self;
  }
}
