// Composes the preview's marks behind the splats in front of them. Their pixels become opaque, and depths become sums
// again, as in a frame without meshes. One invocation a pixel of a view.
#include "shared/limits.h"
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) buffer Colours { vec4 colours[]; };  // C, and T left
layout(std430, binding = 1) buffer ZSums { float z_sums[]; };    // depths, of splats or of marks behind them
layout(binding = 0) uniform sampler2D marks;
uniform uint first;          // the view's first pixel
uniform uint width, height;  // of the view

void main() {
  uint pixel = thread_index();
  if (pixel >= width * height) return;
  vec4 colour = colours[first + pixel];
  vec4 mark = texelFetch(marks, ivec2(pixel % width, height - 1u - pixel / width), 0);
  if (mark.a > 0.0) colour = vec4(colour.rgb + colour.a * mark.rgb, 0.0);
  colours[first + pixel] = colour;
  z_sums[first + pixel] *= 1.0 - colour.a;
}
