// The destination of a blend's pictures: the frame's buffer, or with CANVASES the caller's images, in final form. Part
// of blending.glsl.
#include "display_values.glsl"
#if CANVASES
#include "canvases.glsl"
void write_picture(View view, uint nth, uint to, uvec2 at, vec4 pixel) {
  write_on_canvas(nth, canvases[nth], view.height, at, pixel, frame.background);
}
#else
layout(std430, binding = 4) buffer Colours { vec4 colours[]; };  // C, and the final T
void write_picture(View view, uint nth, uint to, uvec2 at, vec4 pixel) {
  colours[to] = frame.background.w != 0.0 ? displayed(pixel, frame.background.rgb) : pixel;
}
#endif
