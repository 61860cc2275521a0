// Writes a view's depths as OpenGL's values from 0 to 1 into a depth texture, which compute shaders cannot write. If
// the texture has fewer pixels than the view, each texel gets the depth of the view's pixel at the texel's middle.
//   IS_DEPTH    1: z_sums holds depths, at least of every second row, and 0 for none
#include "shared/limits.h"

#if !IS_DEPTH
layout(std430, binding = 0) readonly buffer Colours { vec4 colours[]; };  // C, and the final T
#endif
layout(std430, binding = 1) readonly buffer ZSums { float z_sums[]; };
uniform uint first;                  // the view's first pixel
uniform uint width, height;          // of the view
uniform uint columns, rows;          // of the texture
uniform uint farthest, per_inverse;  // bits of floats: the depth at z is farthest + per_inverse / z

void main() {
  uvec2 at = uvec2(gl_FragCoord.xy);
  at.y = rows - 1u - at.y;
  uvec2 pixel = (2u * at + 1u) * uvec2(width, height) / (2u * uvec2(columns, rows));
  if (2u * rows <= height) pixel.y &= ~1u;
  uint from = first + pixel.y * width + pixel.x;
  float inverse = 0.0;  // transparent and missing pixels are infinitely far
#if IS_DEPTH
  if (z_sums[from] > 0.0) inverse = 1.0 / z_sums[from];
#else
  float cover = 1.0 - colours[from].a;
  if (cover > float(COVERAGE_FOR_DEPTH)) inverse = cover / z_sums[from];
#endif
  gl_FragDepth = clamp(fma(uintBitsToFloat(per_inverse), inverse, uintBitsToFloat(farthest)), 0.0, 1.0);
}
