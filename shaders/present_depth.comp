// A view's depths as OpenGL keeps them, from 0 to 1, the lowest row first: what a texture of depths is filled from.
#include "shared/limits.h"
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Colours { vec4 colours[]; };  // C, and T left
layout(std430, binding = 1) readonly buffer ZSums { float z_sums[]; };
layout(std430, binding = 2) writeonly buffer Depths { float depths[]; };
uniform uint first;           // of the view's pixels
uniform uint width, height;
uniform uint farthest, per_inverse;  // bits of floats: the depth at z is farthest + per_inverse / z

void main() {
  uint at = thread_index();
  if (at >= width * height) return;
  uint pixel = first + (height - 1u - at / width) * width + at % width;
  float cover = 1.0 - colours[pixel].a;
  // What is seen through is infinitely far, as what is not there.
  float inverse = cover > float(COVERAGE_FOR_DEPTH) ? cover / z_sums[pixel] : 0.0;
  depths[at] = clamp(fma(uintBitsToFloat(per_inverse), inverse, uintBitsToFloat(farthest)), 0.0, 1.0);
}
