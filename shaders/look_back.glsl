// What the work groups before this one have counted, in the one dispatch in which they count: each leaves its own count, then the
// sum of all up to it, and looks back from group to group until one knows its sum, 32 at a time (Merrill and Garland 2016). It
// waits for groups that have begun only: they take their numbers as they begin. For subgroups of 32 that do arithmetic and ballots.
// The file that includes this defines LOOK_BACK_BINDING and THREADS.
layout(std430, binding = LOOK_BACK_BINDING) coherent volatile buffer LookBack { uint look_back[]; };
uniform uint look_back_half;  // of the words below: this dispatch goes by one and makes the other ready for the next

// At first how many groups have begun and how many words are not 0, of each half; then the words of both, in turn.
#define LOOK_BACK_BEGUN(half) look_back[2u * (half)]
#define LOOK_BACK_USED(half) look_back[2u * (half) + 1u]
#define LOOK_BACK_WORD(half, group) look_back[4u + 2u * (group) + (half)]
#define LOOK_BACK_OWN 1u  // above the count: of the group by itself
#define LOOK_BACK_SUM 2u  // of all up to it
#define LOOK_BACK_BITS 30
#define LOOK_BACK_MOST ((1u << LOOK_BACK_BITS) - 1u)  // sums stop there

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

// The group's number; every invocation must call it, once. A group that has one must call sum_before().
uint take_number() { return looked_up(gl_LocalInvocationIndex == 0u ? atomicAdd(LOOK_BACK_BEGUN(look_back_half), 1u) : 0u); }

// The sum of the counts of all groups with lower numbers; every invocation must call it with its group's count.
uint sum_before(uint number, uint groups, uint own) {
  uint other = 1u - look_back_half;
  for (uint i = number * THREADS + gl_LocalInvocationIndex; i < LOOK_BACK_USED(other); i += groups * THREADS) LOOK_BACK_WORD(other, i) = 0u;
  if (number == 0u && gl_LocalInvocationIndex == 0u) {
    LOOK_BACK_BEGUN(other) = 0u;
    LOOK_BACK_USED(look_back_half) = groups;
  }
  own = min(own, LOOK_BACK_MOST);
  uint sum = 0u;
  if (gl_SubgroupID == 0u) {
    if (gl_SubgroupInvocationID == 0u) LOOK_BACK_WORD(look_back_half, number) = (number == 0u ? LOOK_BACK_SUM : LOOK_BACK_OWN) << LOOK_BACK_BITS | own;
    for (uint end = number; end > 0u;) {
      uint lane = gl_SubgroupInvocationID;
      uint word = lane < end ? LOOK_BACK_WORD(look_back_half, end - 1u - lane) : LOOK_BACK_SUM << LOOK_BACK_BITS;
      uint kind = word >> LOOK_BACK_BITS;
      uint waits = subgroupBallot(kind == 0u).x, sums = subgroupBallot(kind == LOOK_BACK_SUM).x;
      // Those that are there without a gap, up to the first that knows its sum.
      uint there = waits == 0u ? 32u : uint(findLSB(waits));
      uint last = sums == 0u ? 32u : uint(findLSB(sums));
      uint taken = min(there, last + 1u);
      uint count = lane < taken ? word & LOOK_BACK_MOST : 0u;
      // In halves, since 32 of the largest counts are more than a word holds.
      uint low = subgroupAdd(count & 0xFFFFu), high = subgroupAdd(count >> 16) + (low >> 16);
      uint found = high >> (LOOK_BACK_BITS - 16) == 0u ? high << 16 | low & 0xFFFFu : LOOK_BACK_MOST;
      sum = min(sum + found, LOOK_BACK_MOST);
      end = last < there ? 0u : end - taken;
    }
    if (gl_SubgroupInvocationID == 0u && number != 0u)
      LOOK_BACK_WORD(look_back_half, number) = LOOK_BACK_SUM << LOOK_BACK_BITS | min(sum + own, LOOK_BACK_MOST);
  }
  return looked_up(sum);
}
