// Replaces the colours of the splats of a one-view frame. One invocation a slot.
#include "shared/limits.h"
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Colours { vec4 colours[]; };
layout(std430, binding = 12) buffer Splats { vec4 splats[]; };  // three each, the last: colour, level of Th
uniform uint slot_count;

void main() {
  uint slot = thread_index();
  if (slot < slot_count) splats[3u * slot + 2u].rgb = colours[slot].rgb;
}
