// Measures the error of a level of detail for each chunk. A picture shows each chunk in a separate square. With FINEST
// the picture shows the finest level: the shader stores it, and computes each chunk's mean colour and visibility.
// Otherwise it computes the squared difference from the finest level, over a background similar to the chunk's mean
// colour. One work group per square; the sums are reproducible.
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Colours { vec4 colours[]; };  // C, and the final T; by pixel
layout(std430, binding = 1) buffer Finest { vec4 finest[]; };             // the same, of the finest level
layout(std430, binding = 2) buffer Backgrounds { vec4 backgrounds[]; };   // by square: mean colour, contrast squared
layout(std430, binding = 3) writeonly buffer Sums { float sums_of_squares[]; };
#if FINEST
layout(std430, binding = 4) readonly buffer ZSums { float z_sums[]; };  // visibility by pixel
#endif
uniform uint square_count;
uniform uint square_side;  // px
uniform uint row_squares;
uniform uint row_pixels;

// The background is assumed to differ from the chunk's mean colour as much as the chunk's pixels do, but at least by
// this: behind a chunk of one colour other colours may appear.
const float min_contrast = 0.125;

shared vec4 sums[THREADS];

vec4 sum_of_all(vec4 of_this) {
  uint self = gl_LocalInvocationIndex;
  sums[self] = of_this;
  barrier();
  for (uint half_way = THREADS / 2u; half_way > 0u; half_way /= 2u) {
    if (self < half_way) sums[self] += sums[self + half_way];
    barrier();
  }
  vec4 sum = sums[0];
  barrier();
  return sum;
}

vec3 shown(vec4 colour, vec3 over) { return clamp(colour.rgb + colour.a * over, 0.0, 1.0); }

void main() {
  uint square = group_index();
  if (square >= square_count) return;
  uint corner = (square / row_squares * row_pixels + square % row_squares) * square_side;
#if FINEST
  vec4 colour = vec4(0.0);
  float squares = 0.0;
#else
  vec3 over = backgrounds[square].rgb;
  float contrast_squared = backgrounds[square].a;
#endif
  float sum = 0.0;
  for (uint k = gl_LocalInvocationIndex; k < square_side * square_side; k += THREADS) {
    uint pixel = corner + k / square_side * row_pixels + k % square_side;
#if FINEST
    finest[pixel] = colours[pixel];
    vec4 covers = vec4(colours[pixel].rgb, 1.0 - colours[pixel].a);
    colour += covers;
    squares += dot(covers.rgb, covers.rgb) / max(3.0 * covers.a, 1e-6);
    sum += z_sums[pixel];
#else
    vec3 apart = shown(colours[pixel], over) - shown(finest[pixel], over);
    float covers = colours[pixel].a - finest[pixel].a;
    sum += dot(apart, apart) / 3.0 + contrast_squared * covers * covers;
#endif
  }
#if FINEST
  vec4 all = sum_of_all(colour);
  vec2 sums_of_square = sum_of_all(vec4(sum, squares, 0.0, 0.0)).xy;
  sum = sums_of_square.x;
  if (gl_LocalInvocationIndex == 0u) {
    vec3 mean = all.a > 0.0 ? all.rgb / all.a : vec3(0.0);
    float deviation_squared = all.a > 0.0 ? max(sums_of_square.y / all.a - dot(mean, mean) / 3.0, 0.0) : 0.0;
    backgrounds[square] = vec4(mean, max(deviation_squared, min_contrast * min_contrast));
  }
#else
  sum = sum_of_all(vec4(sum)).x;
#endif
  if (gl_LocalInvocationIndex == 0u) sums_of_squares[square] = sum;
}
