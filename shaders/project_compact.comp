#if LOOKS_BACK
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#endif
// Stage 1, project, second part: the Gaussians drawn get slots without gaps, in index order, so that the stable sort of
// the next stage breaks ties by index.
//   LOOKS_BACK    1: blocks count and compact in this one dispatch, and the last one leaves the arguments of later ones; 0: blocks
//                 were counted (project_compact_count.comp) and their counts scanned
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 1) readonly buffer DepthKeys { uint depth_keys[]; };
layout(std430, binding = 3) writeonly buffer Keys { uint keys[]; };
layout(std430, binding = 4) writeonly buffer Values { uint values[]; };    // the slots themselves
layout(std430, binding = 5) writeonly buffer Indices { uint indices[]; };  // Gaussian of each slot
#include "frame.glsl"
uniform uint nearest_key;  // less than any key: what is sorted needs fewer bits without it
#if LOOKS_BACK
#define LOOK_BACK_BINDING 2
#include "primitives/look_back.glsl"
layout(std430, binding = 6) buffer FrameCounters { Counters counters; };
#include "count_arguments.glsl"
#else
layout(std430, binding = 2) readonly buffer BlockCounts { uint block_counts[]; };  // scanned
#endif

#define EACH (COMPACT_BLOCK / THREADS)
#define WORDS (THREADS / 32)
shared uint masks[EACH][WORDS];  // of each round: a bit for each Gaussian that is drawn

void main() {
#if LOOKS_BACK
  uint blocks = max(1u, blocks_of(frame.gaussian_count, COMPACT_BLOCK));
  if (group_index() >= blocks) return;
  uint block = take_number();
#else
  uint block = group_index();
  if (block * COMPACT_BLOCK >= frame.gaussian_count || arguments[0].count == 0u) return;
#endif
  uint self = gl_LocalInvocationIndex;
  uint key[EACH];
  for (uint i = 0u; i < EACH; ++i) {
    uint at = block * COMPACT_BLOCK + i * THREADS + self;
    key[i] = at < frame.gaussian_count ? depth_keys[at] : DEPTH_KEY_NONE;
  }
  if (self < EACH * WORDS) masks[self / WORDS][self % WORDS] = 0u;
  barrier();
  uint place[EACH];  // among those of the block
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
#if LOOKS_BACK
  uint before = sum_before(block, blocks, seen);
  if (block + 1u == blocks && self == 0u) set_arguments(before + seen);
#else
  uint before = block_counts[block];
#endif
  for (uint i = 0u; i < EACH; ++i) {
    uint to = before + place[i];
    if (key[i] == DEPTH_KEY_NONE) continue;
#if LOOKS_BACK
    if (to >= capacity) continue;
#endif
    keys[to] = key[i] - nearest_key;
    values[to] = to;
    indices[to] = block * COMPACT_BLOCK + i * THREADS + self;
  }
}
