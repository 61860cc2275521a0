#pragma optionNV(unroll all)
// Radix sort where blocks look back, first: how often each digit of each pass occurs, and all else made ready for the passes
// (sort_scatter_subgroups.comp).
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "shared/arguments.glsl"
#include "primitives/sort_digits.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 1) readonly buffer Keys { uvec4 keys[]; };  // by four: fewer, larger reads
layout(std430, binding = 2) buffer SortDigits { uint digits[]; };
layout(std430, binding = 3) writeonly buffer Reached { uint reached[]; };
uniform uint half_now;  // of the counts, those of this sort; the other half is made ready for the next one

#define ROUNDS (SORT_BLOCK / THREADS / 4)
#define COUNTS (PASSES * DIGITS)
shared uint counts[COUNTS];

void main() {
  uint count = arguments[0].count;
  uint blocks = group_index() < SORT_DIGITS_GROUPS ? blocks_of(count, SORT_BLOCK) : 0u;
  uint self = gl_LocalInvocationIndex;
  for (uint d = self; d < COUNTS; d += THREADS) counts[d] = 0u;
  barrier();
  for (uint block = group_index(); block < blocks; block += SORT_DIGITS_GROUPS) {
    uint first = block * SORT_BLOCK + 4u * self;
    uvec4 four[ROUNDS];  // all are read before the first is waited for
    for (uint i = 0u; i < ROUNDS; ++i) {
      uint at = first + 4u * THREADS * i;
      four[i] = at < count ? keys[at / 4u] : uvec4(0u);
    }
    for (uint d = self; d < DIGITS; d += THREADS) reached[block * DIGITS + d] = 0u;
    for (uint i = 0u; i < ROUNDS; ++i) {
      for (uint k = 0u; k < 4u; ++k) {
        if (first + 4u * THREADS * i + k >= count) continue;
        for (uint pass = 0u; pass < PASSES; ++pass)
          atomicAdd(counts[pass * DIGITS + (four[i][k] >> pass * DIGIT_BITS) % DIGITS], 1u);
      }
    }
  }
  barrier();
  for (uint d = self; d < COUNTS; d += THREADS) {
    if (counts[d] != 0u) atomicAdd(digits[DIGIT_COUNTS + half_now * DIGIT_HALF + d], counts[d]);
  }
  if (group_index() != 0u) return;
  for (uint d = self; d < DIGIT_HALF; d += THREADS) digits[DIGIT_COUNTS + (1u - half_now) * DIGIT_HALF + d] = 0u;
  if (self < SORT_PASSES_MAX) digits[self] = 0u;
}
