// Computes the arguments of later dispatches from the number of Gaussians that an order group draws, and compares the
// number with the buffers' capacity. One invocation calls it. The including file declares `arguments` and `counters`.
#include "shared/arguments.glsl"

uniform uint capacity;  // of the buffers, in Gaussians
uniform uint groups_max;

void set_arguments(uint count) {
  counters.visible += count;
  counters.slots_wanted = max(counters.slots_wanted, count);
  if (count > capacity) {
    atomicOr(counters.overflow, OVERFLOW_ORDER);
    count = 0u;
  }
  arguments[0] = make_arguments(count, groups_max);
}
