// The work by which src/lab/floors.h measures a GPU's peak rates. FLOOR_BYTES copies. FLOOR_ALPHAS blends splats from
// shared memory into four pixels per invocation. FLOOR_FMAS multiplies and adds. The results are not used.
#include "shared/axes.h"
#include "shared/limits.h"
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer From { vec4 from[]; };
layout(std430, binding = 1) writeonly buffer To { vec4 to[]; };
uniform uint count;   // number of vec4s
uniform uint rounds;  // a round has 256 splats, or 256 multiply-adds in each of four lanes

#if FLOOR == FLOOR_ALPHAS
shared vec4 splats[512];  // mean, opacity; conic

vec4 blended(vec4 x, float y) {
  vec4 transmittance = vec4(1.0), sum = vec4(0.0);
  for (uint n = 0u; n < 256u * rounds; ++n) {
    vec4 geometry = splats[2u * (n & 255u)], conic = splats[2u * (n & 255u) + 1u];
    vec4 dx = x - geometry.x;
    float dy = y - geometry.y;
    vec4 q = conic.x * dx * dx + 2.0 * conic.y * dx * dy + conic.z * dy * dy;
    vec4 alpha = min(vec4(ALPHA_MAX), geometry.w * exp2(-0.72134752044448170 * q));
    alpha = mix(alpha, vec4(0.0), lessThan(alpha, vec4(ALPHA_MIN)));
    sum += alpha * transmittance * conic.w;
    transmittance *= 1.0 - alpha;
  }
  return sum + transmittance;
}
#endif

void main() {
  uint i = thread_index();
#if FLOOR == FLOOR_ALPHAS
  uint self = gl_LocalInvocationID.x;
  splats[self] = from[self];
  splats[self + THREADS] = from[self + THREADS];
  barrier();
#endif
  if (i >= count) return;
#if FLOOR == FLOOR_BYTES
  to[i] = from[i];
#elif FLOOR == FLOOR_ALPHAS
  to[i] = blended(vec4(0.0, 1.0, 2.0, 3.0) + 4.0 * float(i & 3u), float(i >> 2u & 15u));
#else
  vec4 value = from[i & 255u];
  for (uint n = 0u; n < 256u * rounds; ++n) value = fma(value, vec4(0.99), vec4(0.5));
  to[i] = value;
#endif
}
