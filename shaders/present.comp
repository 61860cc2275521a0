// Writes one picture, or both eyes' pictures in a layout of shared/layout.h, into an image of any format.
//   OVER   1: blends a single picture over the image's colours
#include "shared/layout.h"
#include "display_values.glsl"
#include "shared/grid.glsl"

layout(local_size_x = PRESENT_COLUMNS, local_size_y = PRESENT_ROWS) in;

layout(std430, binding = 0) readonly buffer Colours { vec4 colours[]; };  // C, and the final T
layout(binding = 0) writeonly uniform image2D shown;
#if OVER
layout(binding = 0) uniform sampler2D behind;  // the same image, read before it is written
#endif
uniform uint kind;            // LAYOUT_
uniform uint first, second;   // the eyes' first pixels in `colours`; for a single picture both are equal
uniform uint width, height;   // of an eye
uniform uint columns, rows;   // of the written picture
uniform uint left, bottom;    // lower left corner of the picture in the image
uniform uint background_r, background_g, background_b;  // bits of floats
uniform uint keeps_alpha;     // as in Canvas
uniform uint linear;          // 1: the image stores linear light instead of display values
uniform uint steps;           // largest value of an integer colour channel; 0: float channels

vec4 over(vec4 colour) {
  return over(colour, uintBitsToFloat(uvec3(background_r, background_g, background_b)), keeps_alpha);
}

vec4 pixel_at(uvec2 at) {
  LayoutSource from = layout_source(kind, at.x, at.y, width, height);
  uint pixel = from.y * width + from.x;
  if (from.eye == EYE_BOTH)
    return vec4(layout_mix(kind, over(colours[first + pixel]).rgb, over(colours[second + pixel]).rgb), 1.0);
  uint start = (from.eye == EYE_LEFT ? first : second) + pixel;
  vec4 colour = vec4(0.0);
  for (uint row = 0u; row < from.rows; ++row) {
    for (uint k = 0u; k < from.columns; ++k) colour += colours[start + row * width + k];
  }
  return over(colour / float(from.columns * from.rows));
}

void main() {
  uint across = (columns + PRESENT_COLUMNS - 1u) / PRESENT_COLUMNS;
  uint group = group_index();
  uvec2 at = uvec2(group % across, group / across) * gl_WorkGroupSize.xy + gl_LocalInvocationID.xy;
  if (at.x >= columns || at.y >= rows) return;
  ivec2 to = ivec2(left + at.x, bottom + rows - 1u - at.y);
#if OVER
  vec4 colour = colours[first + at.y * width + at.x];
  if (colour == vec4(0.0, 0.0, 0.0, 1.0)) return;
  vec4 pixel = over_image(colour, texelFetch(behind, to, 0), linear != 0u);
#else
  vec4 pixel = pixel_at(at);
#endif
  imageStore(shown, to, in_image(pixel, linear != 0u, steps));
}
