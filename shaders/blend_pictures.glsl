// The destination of a blend's pictures: the frame's buffer, or with CANVASES the caller's images, in final form. Part
// of blending.glsl.
#include "display_values.glsl"

// With PLAIN the compiler knows that colours are display values, which takes 1 to 2 % less time. Where a subgroup draws a
// whole tile, knowing it takes 3 % more time on an H200 (src/render/README.md).
vec4 background_of_frame() { return PLAIN == 1 && COLUMN != 8 ? vec4(frame.background.rgb, 0.0) : frame.background; }

#if CANVASES
#include "canvases.glsl"
void write_picture(View view, uint nth, uint to, uvec2 at, vec4 pixel) {
  write_on_canvas(nth, canvases[nth], view.height, at, pixel, background_of_frame());
}
#else
layout(std430, binding = 4) buffer Colours { vec4 colours[]; };  // C, and the final T
void write_picture(View view, uint nth, uint to, uvec2 at, vec4 pixel) {
  colours[to] = background_of_frame().w != 0.0 ? displayed(pixel, background_of_frame().rgb) : pixel;
}
#endif
