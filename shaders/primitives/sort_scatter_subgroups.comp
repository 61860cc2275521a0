#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#pragma optionNV(unroll all)
// Radix sort, one pass, second part, where subgroups have 32 invocations: what sort_scatter.comp does. Ranks within a
// subgroup come from ballots, and a block is sorted in shared memory first, so that neighbours write to neighbours.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "shared/arguments.glsl"
#include "shared/saturate.glsl"
// Twice as many invocations hold half as many pairs each, which leaves room for more of them; but counters of 9 bits would take
// up the shared memory.
#if DIGIT_BITS == 8
#undef THREADS
#define THREADS 512
#endif
#define WITH_SUBGROUPS 1
#define SCAN_RESULT_ONLY
#include "primitives/scan_block.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 1) readonly buffer Keys { uint keys[]; };
layout(std430, binding = 2) readonly buffer Values { uint values[]; };
layout(std430, binding = 3) readonly buffer Histogram { uint histogram[]; };
layout(std430, binding = 4) writeonly buffer KeysOut { uint keys_out[]; };
layout(std430, binding = 5) writeonly buffer ValuesOut { uint values_out[]; };
uniform uint shift;

#define DIGITS (1u << DIGIT_BITS)
#define DIGITS_EACH (DIGITS > THREADS ? DIGITS / THREADS : 1u)  // of those that have some
#define SUBGROUPS (THREADS / 32)
#define ROUNDS (SORT_BLOCK / THREADS)
// At first a counter of each subgroup and digit, those of two subgroups in a word: how many keys so far, then where they begin in
// the block. Later the block's keys, then its values, in their new order. In one array, for more groups at a time.
shared uint board[max(SORT_BLOCK, SUBGROUPS / 2 << DIGIT_BITS)];
shared uint moves[DIGITS];  // from a place in the block to the place in the buffer, modulo 2^32

uint digit_of(uint key) { return (key >> shift) % DIGITS; }

void main() {
  uint count = arguments[0].count;
  uint block = group_index();
  if (block * SORT_BLOCK >= count) return;
  uint self = gl_LocalInvocationIndex;
  uint mine = gl_SubgroupID / 2u * DIGITS;
  uint half_shift = gl_SubgroupID % 2u * 16u;  // of this subgroup's counters in their words
  uint first = block * SORT_BLOCK + gl_SubgroupID * 32u * ROUNDS + gl_SubgroupInvocationID;
  for (uint d = self; d < SUBGROUPS / 2 * DIGITS; d += THREADS) board[d] = 0u;
  barrier();
  uint key[ROUNDS];
  uint place[ROUNDS];
  for (uint i = 0u; i < ROUNDS; ++i) key[i] = first + 32u * i < count ? keys[first + 32u * i] : 0u;
  for (uint i = 0u; i < ROUNDS; ++i) {
    uint at = first + 32u * i;
    uint digit = digit_of(key[i]);
    uint equal = subgroupBallot(at < count).x;
    for (uint bit = 0u; bit < DIGIT_BITS; ++bit) {
      bool one = (digit >> bit & 1u) != 0u;
      uint ones = subgroupBallot(one).x;
      equal &= one ? ones : ~ones;
    }
    // The first of the equals counts for all; its answer comes before any of the next round's, so no barrier is needed.
    uint before = uint(bitCount(equal & gl_SubgroupLtMask.x));
    uint seen = 0u;
    if (at < count && before == 0u) {
      seen = atomicAdd(board[mine + digit], uint(bitCount(equal)) << half_shift) >> half_shift & 0xFFFFu;
    }
    place[i] = before + subgroupShuffle(seen, uint(findLSB(equal)) % 32u);
  }
  barrier();
  uint digits = self * DIGITS_EACH < DIGITS ? DIGITS_EACH : 0u;
  uint of_mine = 0u;
  for (uint k = 0u; k < digits; ++k) {
    for (uint s = 0u; s < SUBGROUPS / 2; ++s) {
      uint of_two = board[s * DIGITS + self * DIGITS_EACH + k];
      of_mine += (of_two & 0xFFFFu) + (of_two >> 16);
    }
  }
  uint start = scan_group(of_mine);
  for (uint k = 0u; k < digits; ++k) {
    uint digit = self * DIGITS_EACH + k;
    moves[digit] = histogram[digit * blocks_of(count, SORT_BLOCK) + block] - start;
    for (uint s = 0u; s < SUBGROUPS / 2; ++s) {
      uint of_two = board[s * DIGITS + digit];
      uint second = start + (of_two & 0xFFFFu);
      board[s * DIGITS + digit] = start | second << 16;
      start = second + (of_two >> 16);
    }
  }
  barrier();
  for (uint i = 0u; i < ROUNDS; ++i) place[i] += board[mine + digit_of(key[i])] >> half_shift & 0xFFFFu;
  barrier();
  for (uint i = 0u; i < ROUNDS; ++i) {
    if (first + 32u * i < count) board[place[i]] = key[i];
  }
  barrier();
  uint here = min(count - block * SORT_BLOCK, uint(SORT_BLOCK));
  uint to[ROUNDS];
  uint value[ROUNDS];
  for (uint i = 0u; i < ROUNDS; ++i) value[i] = first + 32u * i < count ? values[first + 32u * i] : 0u;
  for (uint i = 0u; i < ROUNDS; ++i) {
    uint at = i * THREADS + self;
    if (at >= here) continue;
    to[i] = at + moves[digit_of(board[at])];
    keys_out[to[i]] = board[at];
  }
  barrier();
  for (uint i = 0u; i < ROUNDS; ++i) {
    if (first + 32u * i < count) board[place[i]] = value[i];
  }
  barrier();
  for (uint i = 0u; i < ROUNDS; ++i) {
    uint at = i * THREADS + self;
    if (at < here) values_out[to[i]] = board[at];
  }
}
