#pragma optionNV(unroll all)
// Radix sort, one pass of DIGIT_BITS, first part: how often each digit occurs in each block of SORT_BLOCK keys. Counters lie
// digit by digit, so that their scan is where each block's keys of a digit go (Satish, Harris and Garland 2009).
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "shared/arguments.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 1) readonly buffer Keys { uvec4 keys[]; };  // by four: fewer, larger reads
layout(std430, binding = 2) writeonly buffer Histogram { uint histogram[]; };
uniform uint shift;  // of the digit in the key

#define DIGITS (1u << DIGIT_BITS)
#define ROUNDS (SORT_BLOCK / THREADS / 4)
shared uint counts[DIGITS];

void main() {
  uint count = arguments[0].count;
  uint block = group_index();
  if (block * SORT_BLOCK >= count) return;
  for (uint d = gl_LocalInvocationIndex; d < DIGITS; d += THREADS) counts[d] = 0u;
  barrier();
  uint first = block * SORT_BLOCK + 4u * gl_LocalInvocationIndex;
  uvec4 four[ROUNDS];  // all are read before the first is waited for
  for (uint i = 0u; i < ROUNDS; ++i) {
    uint at = first + 4u * THREADS * i;
    four[i] = at < count ? keys[at / 4u] : uvec4(0u);
  }
  for (uint i = 0u; i < ROUNDS; ++i) {
    for (uint k = 0u; k < 4u; ++k) {
      if (first + 4u * THREADS * i + k < count) atomicAdd(counts[(four[i][k] >> shift) % DIGITS], 1u);
    }
  }
  barrier();
  uint blocks = blocks_of(count, SORT_BLOCK);
  for (uint d = gl_LocalInvocationIndex; d < DIGITS; d += THREADS) histogram[d * blocks + block] = counts[d];
}
