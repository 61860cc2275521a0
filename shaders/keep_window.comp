// Copies a window's pixels to their places in a picture, ten times as fast as a driver's buffer copies. One invocation
// per pixel.
#include "shared/limits.h"
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Colours { vec4 colours[]; };  // C, and the final T; over black
layout(std430, binding = 1) writeonly buffer Wanted { vec4 wanted[]; };   // C
uniform uint pixel_count;  // of the window
uniform uint width;        // px, of the window
uniform uint first;        // first pixel in the picture
uniform uint pitch;        // px from row to row of the picture

void main() {
  uint pixel = thread_index();
  if (pixel < pixel_count) wanted[first + pixel / width * pitch + pixel % width] = colours[pixel];
}
