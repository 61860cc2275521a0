// Radix sort, one pass, second part: every key and its value to their place, keys of equal digit in their old order.
// A key's rank among its round's equal digits comes from bit masks, one bit an invocation: no subgroups needed, and the
// order in which the atomics run does not matter. sort_scatter_subgroups.comp does the same where there are subgroups.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "shared/arguments.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 1) readonly buffer Keys { uint keys[]; };
layout(std430, binding = 2) readonly buffer Values { uint values[]; };
layout(std430, binding = 3) readonly buffer Histogram { uint histogram[]; };
layout(std430, binding = 4) writeonly buffer KeysOut { uint keys_out[]; };
layout(std430, binding = 5) writeonly buffer ValuesOut { uint values_out[]; };
uniform uint shift;

#define DIGITS (1u << DIGIT_BITS)
#define WORDS (THREADS / 32)
shared uint masks[DIGITS * WORDS];  // who has the digit in this round
shared uint places[DIGITS];         // where the digit's next key goes

void main() {
  uint count = arguments[0].count;
  uint block = group_index();
  if (block * SORT_BLOCK >= count) return;
  uint self = gl_LocalInvocationIndex;
  // Each invocation looks after the digits of its own number, and every THREADS on.
  for (uint d = self; d < DIGITS; d += THREADS) {
    places[d] = histogram[d * blocks_of(count, SORT_BLOCK) + block];
    for (uint w = 0u; w < WORDS; ++w) masks[d * WORDS + w] = 0u;
  }
  barrier();
  for (uint i = 0u; i < SORT_BLOCK / THREADS; ++i) {
    uint at = block * SORT_BLOCK + i * THREADS + self;
    uint key = at < count ? keys[at] : 0u;
    uint digit = (key >> shift) % DIGITS;
    uint word = self / 32u;
    uint bit = self % 32u;
    if (at < count) atomicOr(masks[digit * WORDS + word], 1u << bit);
    barrier();
    if (at < count) {
      uint rank = uint(bitCount(masks[digit * WORDS + word] & ((1u << bit) - 1u)));
      for (uint w = 0u; w < word; ++w) rank += uint(bitCount(masks[digit * WORDS + w]));
      uint to = places[digit] + rank;
      keys_out[to] = key;
      values_out[to] = values[at];
    }
    barrier();
    for (uint d = self; d < DIGITS; d += THREADS) {
      uint seen = 0u;
      for (uint w = 0u; w < WORDS; ++w) {
        seen += uint(bitCount(masks[d * WORDS + w]));
        masks[d * WORDS + w] = 0u;
      }
      places[d] += seen;
    }
    barrier();
  }
}
