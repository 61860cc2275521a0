// A view's depths as OpenGL keeps them, from 0 to 1, into a texture of depths, which no compute shader can write. A texture of
// fewer pixels than the view has that of the view's pixel in the middle of each of its own.
//   IS_DEPTH    1: what lies in z_sums is the depth itself, of every second row at least; 0: none
#include "shared/limits.h"

#if !IS_DEPTH
layout(std430, binding = 0) readonly buffer Colours { vec4 colours[]; };  // C, and T left
#endif
layout(std430, binding = 1) readonly buffer ZSums { float z_sums[]; };
uniform uint first;                  // of the view's pixels
uniform uint width, height;          // of the view
uniform uint columns, rows;          // of the texture
uniform uint farthest, per_inverse;  // bits of floats: the depth at z is farthest + per_inverse / z

void main() {
  uvec2 at = uvec2(gl_FragCoord.xy);
  at.y = rows - 1u - at.y;
  uvec2 pixel = (2u * at + 1u) * uvec2(width, height) / (2u * uvec2(columns, rows));
  if (2u * rows <= height) pixel.y &= ~1u;
  uint from = first + pixel.y * width + pixel.x;
  float inverse = 0.0;  // what is seen through is infinitely far, as what is not there
#if IS_DEPTH
  if (z_sums[from] > 0.0) inverse = 1.0 / z_sums[from];
#else
  float cover = 1.0 - colours[from].a;
  if (cover > float(COVERAGE_FOR_DEPTH)) inverse = cover / z_sums[from];
#endif
  gl_FragDepth = clamp(fma(uintBitsToFloat(per_inverse), inverse, uintBitsToFloat(farthest)), 0.0, 1.0);
}
