// Between stages: the total that a scan left becomes the arguments that later dispatches go by, checked against what the
// buffers hold. One invocation.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/arguments.glsl"
#include "shared/saturate.glsl"

layout(local_size_x = 1) in;

layout(std430, binding = 0) writeonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 1) readonly buffer Total { uint total[]; };
layout(std430, binding = 2) buffer FrameCounters { Counters counters; };
uniform uint kind;      // ARGUMENTS_
uniform uint capacity;  // things that the buffers hold
uniform uint groups_max;
uniform uint digit_bits;  // of the radix sort of these things

void main() {
  uint first = 0u;
  uint count = total[0];
  uint wanted = count;
  if (kind == ARGUMENTS_ORDER) {
    counters.visible = saturating_add(counters.visible, count);
    counters.order_wanted = max(counters.order_wanted, count);
  } else if (kind == ARGUMENTS_PAIRS) {
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
    atomicOr(counters.overflow, kind == ARGUMENTS_ORDER ? OVERFLOW_ORDER : OVERFLOW_PAIRS);
    count = 0u;
  }
  arguments[0] = make_arguments(first, count, groups_max);
  // The radix sort's counters: one a block and value of a digit.
  arguments[1] = make_arguments(0u, blocks_of(count, SORT_BLOCK) << digit_bits, groups_max);
}
