// Radix sort, one pass of 8 bits, first part: how often each digit occurs in each block of SORT_BLOCK keys. Counters lie
// digit by digit, so that their scan is where each block's keys of a digit go (Satish, Harris and Garland 2009).
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "shared/amount.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Amounts { Amount amounts[]; };
layout(std430, binding = 1) readonly buffer Keys { uint keys[]; };
layout(std430, binding = 2) writeonly buffer Histogram { uint histogram[]; };
uniform uint shift;  // of the digit in the key

shared uint counts[SORT_DIGITS];

void main() {
  uint count = amounts[0].count;
  uint block = group_index();
  if (block * SORT_BLOCK >= count) return;
  counts[gl_LocalInvocationIndex] = 0u;
  barrier();
  for (uint i = 0u; i < SORT_BLOCK / THREADS; ++i) {
    uint at = block * SORT_BLOCK + i * THREADS + gl_LocalInvocationIndex;
    if (at < count) atomicAdd(counts[(keys[at] >> shift) % SORT_DIGITS], 1u);
  }
  barrier();
  uint digit = gl_LocalInvocationIndex;
  histogram[digit * blocks_of(count, SORT_BLOCK) + block] = counts[digit];
}
