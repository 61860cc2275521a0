// An exclusive scan over the THREADS values of a work group (Hillis and Steele 1986; WITH_SUBGROUPS: by those of 32).
//   SCAN_RESULT_ONLY   defined: only scan_group's result is needed, which takes less shared memory by subgroups
#ifndef WITH_SUBGROUPS
#define WITH_SUBGROUPS 0
#endif

#if !WITH_SUBGROUPS || !defined(SCAN_RESULT_ONLY)
#define SCAN_SUMS
shared uint scan_sums[THREADS];
#endif

// The sum of the values before this invocation's; every invocation must call it.
#if WITH_SUBGROUPS  // of numbers whose sum stays below COUNT_MAX: two barriers instead of seventeen
shared uint subgroup_sums[THREADS / 32];

uint scan_group(uint value) {
  uint sum = subgroupInclusiveAdd(value);
  if (gl_SubgroupInvocationID == 31u) subgroup_sums[gl_SubgroupID] = sum;
  memoryBarrierShared();
  barrier();
  for (uint k = 0u; k < THREADS / 32; ++k) sum += k < gl_SubgroupID ? subgroup_sums[k] : 0u;
#ifdef SCAN_SUMS
  scan_sums[gl_LocalInvocationIndex] = sum;
#endif
  memoryBarrierShared();
  barrier();
  return sum - value;
}
#else
uint scan_group(uint value) {
  uint at = gl_LocalInvocationIndex;
  scan_sums[at] = value;
  barrier();
  for (uint step = 1u; step < THREADS; step <<= 1) {
    uint before = at >= step ? scan_sums[at - step] : 0u;
    barrier();
    scan_sums[at] = saturating_add(scan_sums[at], before);
    barrier();
  }
  return at == 0u ? 0u : scan_sums[at - 1u];
}
#endif

#ifdef SCAN_SUMS

// The same for neighbours that each invocation holds, so that the group scans once: each becomes what comes before it,
// `before` included.
#define SCAN_EACH (SCAN_BLOCK / THREADS)
void scan_neighbours(uint before, inout uint mine[SCAN_EACH]) {
  uint sum = 0u;
  for (uint i = 0u; i < SCAN_EACH; ++i) sum = saturating_add(sum, mine[i]);
  before = saturating_add(before, scan_group(sum));
  for (uint i = 0u; i < SCAN_EACH; ++i) {
    uint value = mine[i];
    mine[i] = before;
    before = saturating_add(before, value);
  }
}

// Of THREADS sums, the last that is at most `value`: `at`.
#define LAST_BEFORE(sums, value, at) \
  uint at = 0u;                      \
  for (uint half_way = THREADS / 2u; half_way > 0u; half_way /= 2u) at += sums[at + half_way] <= (value) ? half_way : 0u;

// Of the sums that scan_group leaves, each with its own value, the first above `value`: `at`.
#define FIRST_AFTER(sums, value, at) \
  uint at = 0u;                      \
  for (uint half_way = THREADS / 2u; half_way > 0u; half_way /= 2u) at += sums[at + half_way - 1u] <= (value) ? half_way : 0u;

// The sum over all invocations; after scan_group or scan_neighbours.
uint group_total() { return scan_sums[THREADS - 1u]; }

// The same where the group is to scan again: NVIDIA's compiler (580.159) moves the reading of shared memory beyond a barrier()
// that stands alone.
uint take_group_total() {
  uint total = group_total();
  memoryBarrierShared();
  barrier();
  return total;
}

#endif
