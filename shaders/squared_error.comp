// The squared error of drawn pixels against wanted pixels, summed by work group. This compares many frames without
// reading pictures back. An invocation takes every (group_count * THREADS)th pixel.
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Colours { vec4 colours[]; };  // C, and the final T; over black
layout(std430, binding = 1) readonly buffer Wanted { vec4 wanted[]; };    // C
layout(std430, binding = 2) writeonly buffer Sums { float sums_of_groups[]; };
layout(std430, binding = 3) readonly buffer Exposure { vec4 exposure[3]; };  // rows that transform a drawn (r, g, b, 1)
uniform uint pixel_count;
uniform uint group_count;
uniform uint levels;  // 0: colours are not rounded; 255: both are rounded to 8 bits

shared float sums[THREADS];

vec3 kept(vec3 colour) {
  vec3 shown = clamp(colour, 0.0, 1.0);
  return levels == 0u ? shown : floor(shown * float(levels) + 0.5) / float(levels);
}

vec3 exposed(vec3 colour) {
  vec4 c = vec4(colour, 1.0);
  return vec3(dot(c, exposure[0]), dot(c, exposure[1]), dot(c, exposure[2]));
}

void main() {
  uint self = gl_LocalInvocationIndex, group = group_index();
  float sum = 0.0;
  if (group < group_count) {
    for (uint pixel = thread_index(); pixel < pixel_count; pixel += group_count * THREADS) {
      vec3 d = kept(exposed(colours[pixel].rgb)) - kept(wanted[pixel].rgb);
      sum += dot(d, d);
    }
  }
  sums[self] = sum;
  barrier();
  for (uint half_way = THREADS / 2u; half_way > 0u; half_way /= 2u) {
    if (self < half_way) sums[self] += sums[self + half_way];
    barrier();
  }
  if (self == 0u && group < group_count) sums_of_groups[group] = sums[0];
}
