// Converts a blended pixel (C, and the final T) to an image's final value.
#ifndef PLAIN
#define PLAIN 0  // 1: no alpha multiplies light (blending.glsl)
#endif

vec3 light_of(vec3 shown) {
  vec3 low = shown / 12.92, high = pow((max(shown, vec3(0.0)) + 0.055) / 1.055, vec3(2.4));
  return mix(high, low, lessThanEqual(shown, vec3(0.04045)));
}

vec3 shown_of(vec3 light) {
  vec3 low = light * 12.92, high = 1.055 * pow(max(light, vec3(0.0)), vec3(1.0 / 2.4)) - 0.055;
  return mix(high, low, lessThanEqual(light, vec3(0.0031308)));
}

// Puts a blended pixel over the background, or keeps its alpha (Canvas::keeps_alpha).
vec4 over(vec4 colour, vec3 background, uint keeps_alpha) {
  if (keeps_alpha == 0u) return vec4(colour.rgb + colour.a * background, 1.0);
  float alpha = 1.0 - colour.a;
  if (PLAIN == 0 && keeps_alpha == 2u && alpha > 0.0) colour.rgb = shown_of(alpha * light_of(colour.rgb / alpha));
  return vec4(colour.rgb, alpha);
}

// Converts a blended pixel of linear light, so that over `behind` it has the display value of the light.
vec4 displayed(vec4 pixel, vec3 behind) {
  pixel.rgb = shown_of(pixel.rgb + pixel.a * light_of(behind)) - pixel.a * behind;
  return pixel;
}

// Blends over a pixel of an image, whose colours are premultiplied by alpha.
vec4 over_image(vec4 colour, vec4 there, bool is_light) {
  if (is_light) there.rgb = shown_of(there.rgb);
  return vec4(colour.rgb + colour.a * there.rgb, 1.0 - colour.a * (1.0 - there.a));
}

// Converts a pixel for an image that stores linear light or display values. `steps` is the largest value of an integer
// colour channel, or 0 for float channels. Rounds to the nearest step, because a GPU may store a value up to 0.6 steps
// away.
vec4 in_image(vec4 pixel, bool is_light, uint steps) {
  if (is_light) pixel.rgb = light_of(pixel.rgb);
  if (steps != 0u) pixel.rgb = floor(clamp(pixel.rgb, 0.0, 1.0) * float(steps) + 0.5) / float(steps);
  return pixel;
}
