// Copies the pixels of a window to their places in a picture: copies of buffers take a driver ten times as long. One
// invocation a pixel.
#include "shared/limits.h"
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Colours { vec4 colours[]; };  // C, and T left; over black
layout(std430, binding = 1) writeonly buffer Wanted { vec4 wanted[]; };   // C
uniform uint pixel_count;  // of the window
uniform uint width;        // likewise
uniform uint first;        // pixel of the picture,
uniform uint pitch;        // of which rows are so many apart

void main() {
  uint pixel = thread_index();
  if (pixel < pixel_count) wanted[first + pixel / width * pitch + pixel % width] = colours[pixel];
}
