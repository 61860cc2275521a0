// The caller's images, into which the blend writes views' final pictures.
//   MESH_DEPTH  1: blends over the images' colours
#include "shared/types.h"
#include "display_values.glsl"

layout(std430, binding = 4) readonly buffer Canvases { Canvas canvases[]; };
layout(binding = 0) writeonly uniform image2D image_0;
layout(binding = 1) writeonly uniform image2D image_1;
layout(binding = 2) writeonly uniform image2D image_2;
layout(binding = 3) writeonly uniform image2D image_3;

#if MESH_DEPTH
// The same images, from which each pixel is read before it is written.
layout(binding = 0) uniform sampler2D behind_0;
layout(binding = 1) uniform sampler2D behind_1;
layout(binding = 2) uniform sampler2D behind_2;
layout(binding = 3) uniform sampler2D behind_3;

vec4 behind_at(uint nth, ivec2 at) {
  if (nth == 1u) return texelFetch(behind_1, at, 0);
  if (nth == 2u) return texelFetch(behind_2, at, 0);
  if (nth == 3u) return texelFetch(behind_3, at, 0);
  return texelFetch(behind_0, at, 0);
}
#endif

// Writes a blended pixel to the image of unit `nth`. `at` counts from the upper left of a view `height` px high.
void write_on_canvas(uint nth, Canvas canvas, uint height, uvec2 at, vec4 pixel, vec4 background) {
  ivec2 to = ivec2(canvas.left + at.x, canvas.bottom + height - 1u - at.y);
#if MESH_DEPTH
  if (pixel == vec4(0.0, 0.0, 0.0, 1.0)) return;  // the image keeps its exact value
  vec4 there = behind_at(nth, to);
  if (background.w != 0.0) pixel = displayed(pixel, canvas.linear != 0u ? shown_of(there.rgb) : there.rgb);
  vec4 over_it = over_image(pixel, there, canvas.linear != 0u);
#else
  if (background.w != 0.0) pixel = displayed(pixel, canvas.keeps_alpha != 0u ? vec3(0.0) : background.rgb);
  vec4 over_it = over(pixel, background.rgb, canvas.keeps_alpha);
#endif
  vec4 shown = in_image(over_it, canvas.linear != 0u, canvas.steps);
  if (nth == 0u) imageStore(image_0, to, shown);
  if (nth == 1u) imageStore(image_1, to, shown);
  if (nth == 2u) imageStore(image_2, to, shown);
  if (nth == 3u) imageStore(image_3, to, shown);
}
