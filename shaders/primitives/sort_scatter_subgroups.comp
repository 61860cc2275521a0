#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#pragma optionNV(unroll all)
// Radix sort, one pass in one dispatch, where subgroups have 32 invocations: what sort_count.comp and sort_scatter.comp do.
// Ranks within a subgroup come from ballots, and a block is sorted in shared memory first, so that neighbours write to neighbours.
// Where its keys of a digit go a block learns by looking back at those before it, until one knows it (Merrill and Garland 2016;
// Adinets and Merrill 2022). It waits for blocks that have begun only: they take their numbers as they begin.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "shared/arguments.glsl"
#include "shared/saturate.glsl"
#define WITH_SUBGROUPS 1
#define SCAN_RESULT_ONLY
#include "primitives/scan_block.glsl"
#include "primitives/sort_digits.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 1) readonly buffer Keys { uint keys[]; };
layout(std430, binding = 2) readonly buffer Values { uint values[]; };
layout(std430, binding = 3) coherent volatile buffer Reached { uint reached[]; };
layout(std430, binding = 4) writeonly buffer KeysOut { uint keys_out[]; };
layout(std430, binding = 5) writeonly buffer ValuesOut { uint values_out[]; };
layout(std430, binding = 6) buffer SortDigits { uint digits[]; };
uniform uint pass;
uniform uint half_now;  // of the counts

// How many keys of a digit: of a block by itself, or of all up to it. The latter's sign is that of the pass, since what is left
// of the one before must not count: it was 0 before the first.
#define REACHED_SUM (pass % 2u + 1u)
#define REACHED_OWN 3u
#define REACHED_BITS 30
// Blocks that are looked at together.
#define AHEAD 2u

#define DIGITS_EACH (DIGITS / THREADS)
#define SUBGROUPS (THREADS / 32)
#define ROUNDS (SORT_BLOCK / THREADS)
// At first a counter of each subgroup and digit, those of two subgroups in a word: how many keys so far, then where they begin in
// the block. Later the block's keys, then its values, in their new order. In one array, for more groups at a time.
shared uint board[max(SORT_BLOCK, SUBGROUPS / 2 << DIGIT_BITS)];
shared uint moves[DIGITS];  // from a place in the block to the place in the buffer, modulo 2^32
shared uint ticket;

uint digit_of(uint key) { return (key >> pass * DIGIT_BITS) % DIGITS; }

// Of a digit, in all blocks before.
uint sum_before(uint block, uint digit) {
  uint sum = 0u;
  for (uint end = block; end > 0u;) {
    uint word[AHEAD];
    for (uint k = 0u; k < AHEAD; ++k) word[k] = reached[(end > k ? end - 1u - k : 0u) * DIGITS + digit];
    uint taken = 0u;
    bool found = false;
    for (uint k = 0u; k < AHEAD; ++k) {
      uint kind = word[k] >> REACHED_BITS;
      if (found || taken != k || k >= end || (kind != REACHED_OWN && kind != REACHED_SUM)) continue;
      sum += word[k] & (1u << REACHED_BITS) - 1u;
      ++taken;
      found = kind == REACHED_SUM;
    }
    end = found ? 0u : end - taken;
  }
  return sum;
}

void main() {
  uint count = arguments[0].count;
  uint self = gl_LocalInvocationIndex;
  if (group_index() >= blocks_of(count, SORT_BLOCK)) return;
  if (self == 0u) ticket = atomicAdd(digits[pass], 1u);
  memoryBarrierShared();
  barrier();
  uint block = ticket;
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
  uint of_mine = 0u, of_all = 0u;
  uint own[DIGITS_EACH], everywhere[DIGITS_EACH];
  for (uint k = 0u; k < DIGITS_EACH; ++k) {
    uint digit = self * DIGITS_EACH + k;
    own[k] = 0u;
    for (uint s = 0u; s < SUBGROUPS / 2; ++s) {
      uint of_two = board[s * DIGITS + digit];
      own[k] += (of_two & 0xFFFFu) + (of_two >> 16);
    }
    reached[block * DIGITS + digit] = (block == 0u ? REACHED_SUM : REACHED_OWN) << REACHED_BITS | own[k];
    everywhere[k] = digits[DIGIT_COUNTS + half_now * DIGIT_HALF + pass * DIGITS + digit];
    of_mine += own[k];
    of_all += everywhere[k];
  }
  uint start = scan_group(of_mine);
  uint begin = scan_group(of_all);
  for (uint k = 0u; k < DIGITS_EACH; ++k) {
    uint digit = self * DIGITS_EACH + k;
    uint before = sum_before(block, digit);
    if (block != 0u) reached[block * DIGITS + digit] = REACHED_SUM << REACHED_BITS | before + own[k];
    moves[digit] = begin + before - start;
    begin += everywhere[k];
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
