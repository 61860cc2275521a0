// Replaces the splats' colours of a frame with one view. One invocation per slot.
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Colours { vec4 colours[]; };
layout(std430, binding = 12) buffer Splats { vec4 splats[]; };  // three per splat; the third: colour, rho
uniform uint slot_count;

void main() {
  uint slot = thread_index();
  if (slot < slot_count) splats[3u * slot + 2u].rgb = colours[slot].rgb;
}
