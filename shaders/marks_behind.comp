// Composes the preview's marks behind the splats that are in front of them. Pixels with a mark become opaque. Depths
// become sums of alpha T z again, as in a frame without meshes. One invocation per pixel of a view.
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) buffer Colours { vec4 colours[]; };  // C, and the final T
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
