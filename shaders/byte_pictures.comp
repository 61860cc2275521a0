// Rounds drawn pixels to 8 bits, in a word each, for comparisons in 8 bits. One invocation per pixel.
#include "shared/grid.glsl"
#include "shared/bytes.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Colours { vec4 colours[]; };  // C, and the final T; over black
layout(std430, binding = 1) writeonly buffer Kept { uint kept[]; };       // red in the lowest byte
uniform uint first_pixel;
uniform uint first_kept;
uniform uint pixel_count;

void main() {
  uint pixel = thread_index();
  if (pixel >= pixel_count) return;
  uvec3 bytes = uvec3(in_bytes(colours[first_pixel + pixel].rgb));
  kept[first_kept + pixel] = bytes.r | bytes.g << 8u | bytes.b << 16u;
}
