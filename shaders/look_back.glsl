// Prefix sums of the counts of a dispatch's work groups, computed in the same dispatch (Merrill and Garland 2016). Each
// group stores its own count, then the sum of all counts up to its own. For the sum it looks back over earlier groups,
// 32 at a time, to the nearest that has stored its sum. Groups get numbers as they begin: a group waits only for groups
// that have begun. Requires subgroups of 32 with arithmetic and ballots. The including file defines LOOK_BACK_BINDING
// and THREADS.
layout(std430, binding = LOOK_BACK_BINDING) coherent volatile buffer LookBack { uint look_back[]; };
uniform uint look_back_half;  // this dispatch uses one half of the words below, and clears the other for the next

// The buffer begins with two numbers for each half: how many groups have begun, and how many words are not 0. Then come
// the words, alternately of each half.
#define LOOK_BACK_BEGUN(half) look_back[2u * (half)]
#define LOOK_BACK_USED(half) look_back[2u * (half) + 1u]
#define LOOK_BACK_WORD(half, group) look_back[4u + 2u * (group) + (half)]
#define LOOK_BACK_OWN 1u  // in the bits above the count: marks the group's own count
#define LOOK_BACK_SUM 2u  // in the bits above the count: marks the sum up to this group
#define LOOK_BACK_BITS 30
#define LOOK_BACK_MAX ((1u << LOOK_BACK_BITS) - 1u)  // larger sums saturate at this

shared uint look_back_shared;

uint looked_up(uint value) {
  if (gl_LocalInvocationIndex == 0u) look_back_shared = value;
  memoryBarrierShared();
  barrier();
  value = look_back_shared;
  memoryBarrierShared();
  barrier();
  return value;
}

// Returns the group's number; every invocation must call it, once. A group with a number must call sum_before().
uint take_number() { return looked_up(gl_LocalInvocationIndex == 0u ? atomicAdd(LOOK_BACK_BEGUN(look_back_half), 1u) : 0u); }

// Returns the sum of the counts of all groups with lower numbers; every invocation must call it with its group's count.
uint sum_before(uint number, uint groups, uint own) {
  uint other = 1u - look_back_half;
  for (uint i = number * THREADS + gl_LocalInvocationIndex; i < LOOK_BACK_USED(other); i += groups * THREADS) LOOK_BACK_WORD(other, i) = 0u;
  if (number == 0u && gl_LocalInvocationIndex == 0u) {
    LOOK_BACK_BEGUN(other) = 0u;
    LOOK_BACK_USED(look_back_half) = groups;
  }
  own = min(own, LOOK_BACK_MAX);
  uint sum = 0u;
  if (gl_SubgroupID == 0u) {
    if (gl_SubgroupInvocationID == 0u) LOOK_BACK_WORD(look_back_half, number) = (number == 0u ? LOOK_BACK_SUM : LOOK_BACK_OWN) << LOOK_BACK_BITS | own;
    for (uint end = number; end > 0u;) {
      uint lane = gl_SubgroupInvocationID;
      uint word = lane < end ? LOOK_BACK_WORD(look_back_half, end - 1u - lane) : LOOK_BACK_SUM << LOOK_BACK_BITS;
      uint kind = word >> LOOK_BACK_BITS;
      uint waits = subgroupBallot(kind == 0u).x, sums = subgroupBallot(kind == LOOK_BACK_SUM).x;
      // Takes the words of the nearest groups, up to the first missing word or sum.
      uint there = waits == 0u ? 32u : uint(findLSB(waits));
      uint last = sums == 0u ? 32u : uint(findLSB(sums));
      uint taken = min(there, last + 1u);
      uint count = lane < taken ? word & LOOK_BACK_MAX : 0u;
      // Adds halves of words, because 32 of the largest counts exceed a word.
      uint low = subgroupAdd(count & 0xFFFFu), high = subgroupAdd(count >> 16) + (low >> 16);
      uint found = high >> (LOOK_BACK_BITS - 16) == 0u ? high << 16 | low & 0xFFFFu : LOOK_BACK_MAX;
      sum = min(sum + found, LOOK_BACK_MAX);
      end = last < there ? 0u : end - taken;
    }
    if (gl_SubgroupInvocationID == 0u && number != 0u)
      LOOK_BACK_WORD(look_back_half, number) = LOOK_BACK_SUM << LOOK_BACK_BITS | min(sum + own, LOOK_BACK_MAX);
  }
  return looked_up(sum);
}
