// After the blend: the squared error of a strip of a view against the same strip drawn exactly, summed for --quality. One
// invocation a pixel.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Colours { vec4 colours[]; };  // C, and T left
layout(std430, binding = 1) buffer FrameCounters { Counters counters; };
uniform uint pixel_count;
uniform uint exact_first;
uniform uint judged_first;
uniform uint background_r, background_g, background_b;  // bits of floats

shared float sums[THREADS];

void main() {
  uint pixel = thread_index();
  uint self = gl_LocalInvocationIndex;
  sums[self] = 0.0;
  if (pixel < pixel_count) {
    vec3 background = uintBitsToFloat(uvec3(background_r, background_g, background_b));
    vec4 exact = colours[exact_first + pixel];
    vec4 judged = colours[judged_first + pixel];
    vec3 d = clamp(exact.rgb + exact.a * background, 0.0, 1.0) - clamp(judged.rgb + judged.a * background, 0.0, 1.0);
    sums[self] = dot(d, d);
  }
  barrier();
  for (uint half_way = THREADS / 2u; half_way > 0u; half_way /= 2u) {
    if (self < half_way) sums[self] += sums[self + half_way];
    barrier();
  }
  if (self != 0u) return;
  // Whole numbers, so that the order of the additions does not matter.
  uint sum = uint(sums[0] * float(PROBE_SCALE));
  uint before = atomicAdd(counters.probe_low, sum);
  if (before + sum < before) atomicAdd(counters.probe_high, 1u);
}
