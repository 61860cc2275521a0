// Both eyes' pictures, or one, into the framebuffer that is bound: shared/layout.h says which pixel goes where. Colours
// are display-referred and written as they are.
#include "shared/layout.h"

layout(std430, binding = 0) readonly buffer Colours { vec4 colours[]; };  // C, and T left
uniform uint kind;            // LAYOUT_
uniform uint first, second;   // the eyes' first pixels in `colours`; of a single picture both are its own
uniform uint width, height;   // of an eye
uniform uint left, bottom;    // of the viewport in the framebuffer
uniform uint rows;            // of the viewport
uniform uint background_r, background_g, background_b;  // bits of floats
uniform uint keeps_alpha;     // 1: no background, but associated alpha

out vec4 shown;

vec4 over(vec4 colour) {
  if (keeps_alpha != 0u) return vec4(colour.rgb, 1.0 - colour.a);
  return vec4(colour.rgb + colour.a * uintBitsToFloat(uvec3(background_r, background_g, background_b)), 1.0);
}

void main() {
  uvec2 at = uvec2(gl_FragCoord.xy) - uvec2(left, bottom);
  LayoutSource from = layout_source(kind, at.x, rows - 1u - at.y, width, height);
  uint pixel = from.y * width + from.x;
  if (from.eye == EYE_BOTH) {
    shown = vec4(layout_mix(kind, over(colours[first + pixel]).rgb, over(colours[second + pixel]).rgb), 1.0);
    return;
  }
  uint start = (from.eye == EYE_LEFT ? first : second) + pixel;
  vec4 colour = vec4(0.0);
  for (uint k = 0u; k < from.columns; ++k) colour += colours[start + k];
  shown = over(colour / float(from.columns));
}
