// Between stages: the total that a scan left becomes an Amount that later dispatches go by, checked against what the
// buffers hold. One invocation.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/amount.glsl"
#include "shared/saturate.glsl"

layout(local_size_x = 1) in;

layout(std430, binding = 0) writeonly buffer Amounts { Amount amounts[]; };
layout(std430, binding = 1) readonly buffer Total { uint total[]; };
layout(std430, binding = 2) buffer FrameCounters { Counters counters; };
uniform uint kind;      // AMOUNT_
uniform uint capacity;  // things that the buffers hold
uniform uint groups_max;
uniform uint digit_bits;  // of the radix sort of these things

void main() {
  uint first = 0u;
  uint count = total[0];
  uint wanted = count;
  if (kind == AMOUNT_ORDER) {
    counters.visible = saturating_add(counters.visible, count);
    counters.order_wanted = max(counters.order_wanted, count);
  } else if (kind == AMOUNT_PAIRS) {
    first = counters.pairs;
    wanted = saturating_add(first, count);
    counters.pairs = wanted;
    // The next order group leaves splats aside anew; these have made room for something else.
    counters.tall = 0u;
    counters.tall_y = 0u;
  } else {
    count = counters.pairs;
    wanted = count;
  }
  if (wanted > capacity) {
    atomicOr(counters.overflow, kind == AMOUNT_ORDER ? OVERFLOW_ORDER : OVERFLOW_PAIRS);
    count = 0u;
  }
  amounts[0] = make_amount(first, count, groups_max);
  // The radix sort's counters: one a block and value of a digit.
  amounts[1] = make_amount(0u, blocks_of(count, SORT_BLOCK) << digit_bits, groups_max);
}
