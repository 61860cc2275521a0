// A blended pixel (C, and T left) as an image shows it.
#include "shared/types.h"

vec4 over(vec4 colour, vec3 background, bool keeps_alpha) {
  return keeps_alpha ? vec4(colour.rgb, 1.0 - colour.a) : vec4(colour.rgb + colour.a * background, 1.0);
}

vec3 light_of(vec3 shown) {
  vec3 low = shown / 12.92, high = pow((max(shown, vec3(0.0)) + 0.055) / 1.055, vec3(2.4));
  return mix(high, low, lessThanEqual(shown, vec3(0.04045)));
}

// In an image whose numbers mean light, or what a screen takes, and whose colours have `steps` above 0; 0: they are floats.
// GPUs may round by themselves to within 0.6 of a step; files hold the nearest.
vec4 in_image(vec4 pixel, bool is_light, uint steps) {
  if (is_light) pixel.rgb = light_of(pixel.rgb);
  if (steps != 0u) pixel.rgb = floor(clamp(pixel.rgb, 0.0, 1.0) * float(steps) + 0.5) / float(steps);
  return pixel;
}
