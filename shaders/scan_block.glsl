// An exclusive scan over the THREADS values of a work group (WITH_SUBGROUPS: with subgroups of 32).
#ifndef WITH_SUBGROUPS
#define WITH_SUBGROUPS 0
#endif

#define SCAN_ROWS (THREADS / 32)
shared uint row_sums[SCAN_ROWS];
#if !WITH_SUBGROUPS
shared uint scan_values[THREADS];
#endif

// Returns the sum of the values of earlier invocations; every invocation must call it.
uint scan_group(uint value) {
#if WITH_SUBGROUPS
  uint sum = subgroupExclusiveAdd(value), lane = gl_SubgroupInvocationID;
  if (lane == 31u) row_sums[gl_SubgroupID] = sum + value;
  memoryBarrierShared();
  barrier();
  sum += subgroupAdd(lane < gl_SubgroupID ? row_sums[lane] : 0u);
#else
  // One invocation per row of 32 values, then one for the rows: few barriers, which are slow on software renderers.
  uint self = gl_LocalInvocationIndex;
  scan_values[self] = value;
  memoryBarrierShared();
  barrier();
  if (self < SCAN_ROWS) {
    uint before = 0u;
    for (uint k = 32u * self; k < 32u * self + 32u; ++k) {
      uint own = scan_values[k];
      scan_values[k] = before;
      before += own;
    }
    row_sums[self] = before;
  }
  memoryBarrierShared();
  barrier();
  if (self == 0u) {
    uint before = 0u;
    for (uint k = 0u; k < SCAN_ROWS; ++k) {
      uint own = row_sums[k];
      row_sums[k] = before;
      before += own;
    }
  }
  memoryBarrierShared();
  barrier();
  uint sum = scan_values[self] + row_sums[self / 32u];
#endif
  memoryBarrierShared();
  barrier();
  return sum;
}
