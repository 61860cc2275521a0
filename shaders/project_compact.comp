// Stage 1, project, second part: the Gaussians drawn get slots without gaps, in index order, so that the stable sort of
// the next stage breaks ties by index.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 1) readonly buffer DepthKeys { uint depth_keys[]; };
layout(std430, binding = 2) readonly buffer BlockCounts { uint block_counts[]; };  // scanned
layout(std430, binding = 3) writeonly buffer Keys { uint keys[]; };
layout(std430, binding = 4) writeonly buffer Values { uint values[]; };    // the slots themselves
layout(std430, binding = 5) writeonly buffer Indices { uint indices[]; };  // Gaussian of each slot
#include "frame.glsl"
uniform uint nearest_key;  // less than any key: what is sorted needs fewer bits without it

#define EACH (COMPACT_BLOCK / THREADS)
#define WORDS (THREADS / 32)
shared uint masks[EACH][WORDS];  // of each round: a bit for each Gaussian that is drawn

void main() {
  uint block = group_index();
  if (block * COMPACT_BLOCK >= frame.gaussian_count || arguments[0].count == 0u) return;
  uint self = gl_LocalInvocationIndex;
  uint before = block_counts[block];
  uint key[EACH];
  for (uint i = 0u; i < EACH; ++i) {
    uint at = block * COMPACT_BLOCK + i * THREADS + self;
    key[i] = at < frame.gaussian_count ? depth_keys[at] : DEPTH_KEY_NONE;
  }
  if (self < EACH * WORDS) masks[self / WORDS][self % WORDS] = 0u;
  barrier();
  for (uint i = 0u; i < EACH; ++i) {
    uint at = block * COMPACT_BLOCK + i * THREADS + self;
    bool is_drawn = key[i] != DEPTH_KEY_NONE;
    if (is_drawn) atomicOr(masks[i][self / 32u], 1u << (self % 32u));
    barrier();
    uint rank = uint(bitCount(masks[i][self / 32u] & ((1u << (self % 32u)) - 1u)));
    uint all = 0u;
    for (uint w = 0u; w < WORDS; ++w) {
      uint seen = uint(bitCount(masks[i][w]));
      if (w < self / 32u) rank += seen;
      all += seen;
    }
    if (is_drawn) {
      keys[before + rank] = key[i] - nearest_key;
      values[before + rank] = before + rank;
      indices[before + rank] = at;
    }
    before += all;
  }
}
