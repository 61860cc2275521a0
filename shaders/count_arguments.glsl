// A total that was counted becomes the arguments that later dispatches go by, checked against what the buffers hold. One
// invocation. The file that includes this declares `arguments` and `counters`.
#include "shared/arguments.glsl"
#include "shared/saturate.glsl"

uniform uint kind;      // ARGUMENTS_
uniform uint capacity;  // things that the buffers hold
uniform uint groups_max;
uniform uint digit_bits;  // of the radix sort of these things

void set_arguments(uint count) {
  uint first = 0u;
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
  if (kind == ARGUMENTS_ORDER) return;
  // The blocks that lists of tiles are made by, THREADS for each, and their counts.
  arguments[2] = make_arguments(0u, blocks_of(count, TILE_BLOCK) * THREADS, groups_max);
  arguments[3] = make_arguments(0u, blocks_of(count, TILE_BLOCK) * SUPERTILE_TILES_MOST, groups_max);
}
