// How many Gaussians an order group draws becomes the arguments of later dispatches, checked against what the buffers hold. One
// invocation. The file that includes this declares `arguments` and `counters`.
#include "shared/arguments.glsl"

uniform uint capacity;  // Gaussians that the buffers hold
uniform uint groups_max;

void set_arguments(uint count) {
  counters.visible += count;
  counters.order_wanted = max(counters.order_wanted, count);
  if (count > capacity) {
    atomicOr(counters.overflow, OVERFLOW_ORDER);
    count = 0u;
  }
  arguments[0] = make_arguments(count, groups_max);
}
