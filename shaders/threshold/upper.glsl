// T_upper of a Gaussian in a view, or W with contrast: the most that its alpha counted for in a pixel of the last frame
// (METHOD 5). 1 where nothing is known: at first, after a cut, outside the view, beyond the table of depths.

#include "shared/axes.h"
#include "shared/limits.h"

#if TRANSMITTANCE == TRANSMITTANCE_ONE

float upper_of(uint gaussian, uint view, Gaussian g, Splat splat) { return 1.0; }

#elif TRANSMITTANCE == TRANSMITTANCE_DEPTH

layout(std430, binding = 7) readonly buffer DepthTable { float depth_table[]; };  // T_upper of equal bins over [0, far)
uniform uint depth_bins;
uniform uint far_bits;  // world units, a float's bits

float upper_of(uint gaussian, uint view, Gaussian g, Splat splat) {
  precise float bin = splat.depth / uintBitsToFloat(far_bits) * float(depth_bins);
  return bin < float(depth_bins) ? depth_table[uint(bin)] : 1.0;
}

#elif TRANSMITTANCE == TRANSMITTANCE_MAP

#include "light.glsl"

layout(std430, binding = 7) readonly buffer Light { uvec4 light[]; };
uniform uint remembers;   // 0: the last frame tells nothing of this one
uniform uint last_first;  // the last frame's views, among the views
uniform uint moved_bits;  // a float's: px that what is one world unit away has moved at most since then, for the head's own move
uniform uint nearest_bits;  // world units: what hides is hardly nearer

// The most light that the blocks [low, high] of a view let through to a depth in near planes.
float light_through(View view, uvec2 low, uvec2 high, float depth) {
  uint level = 0u;
#ifdef V4
#define REACH 2u
#else
#define REACH 1u
#endif
  while (level <= LIGHT_LEVEL_MAX && ((high.x >> level) > (low.x >> level) + REACH || (high.y >> level) > (low.y >> level) + REACH)) ++level;
  if (level > LIGHT_LEVEL_MAX) return 1.0;
  low >>= level;
  high >>= level;
#ifdef V4
  uvec4 farthest = uvec4(0u);
  uint base = light_place(view, level, uvec2(0u)), across = light_blocks(view, level).x;
  for (uint y = low.y; y <= high.y; ++y)
    for (uint x = low.x; x <= high.x; ++x) farthest = farther(farthest, light[base + y * across + x]);
#else
  uvec4 farthest = light[light_place(view, level, low)];
  if (high.x > low.x) farthest = farther(farthest, light[light_place(view, level, uvec2(high.x, low.y))]);
  if (high.y > low.y) {
    farthest = farther(farthest, light[light_place(view, level, uvec2(low.x, high.y))]);
    if (high.x > low.x) farthest = farther(farthest, light[light_place(view, level, high)]);
  }
#endif
  uint passed = 0u;
  for (uint k = 0u; k < 4u; ++k) {
    vec2 depths = unpackHalf2x16(farthest[k]);
    passed += uint(depth > depths.x) + uint(depth > depths.y);
  }
  return passed == LIGHT_LEVELS ? float(UPPER_FLOOR) : exp2(float(passed) * log2(float(LIGHT_STEP)));
}

// Where the Gaussian lay in the last frame's picture, with all of it that is seen now, and by how much what hides it may have
// moved against it.
float upper_of(uint gaussian, uint v, Gaussian g, Splat splat) {
  if (remembers == 0u) return 1.0;
  precise float s = splat.conic.w;
#ifdef V5
  precise float rho = min(2.0, max(0.0, visible_level(splat.opacity)));
#else
  precise float rho = max(0.0, visible_level(splat.opacity));
#endif
  precise vec2 extent = sqrt(rho * s * s * splat.conic.zx);
  vec2 size = vec2(views[v].width, views[v].height);
  precise vec2 low = max(splat.mean - extent, vec2(0.0)), high = min(splat.mean + extent, size - 1.0);
  if (!(low.x <= high.x && low.y <= high.y)) return 1.0;  // out of sight
  View last = views[last_first + v];
  precise vec3 d = g.position.xyz - last.anchor.xyz;
  vec3 at = to_eye(last, d);
  if (!(at.z > last.anchor.w)) return 1.0;
  precise vec2 moved = last.lens.xy * (at.xy / at.z) + last.lens.zw - 0.5 - splat.mean;
  low += moved;
  high += moved;
  vec2 last_size = vec2(last.width, last.height);
  if (low.x < -1.0 || low.y < -1.0 || high.x > last_size.x || high.y > last_size.y) return 1.0;  // was out of sight
#ifdef V3
  float aside = 0.0;
#else
  precise float aside = uintBitsToFloat(moved_bits) * max(0.0, 1.0 / uintBitsToFloat(nearest_bits) - 1.0 / at.z);
#endif
  uvec2 first = uvec2(max(low - aside, 0.0)) / uint(LIGHT_BLOCK);
  uvec2 end = uvec2(min(high + aside, last_size - 1.0)) / uint(LIGHT_BLOCK);
  return light_through(last, min(first, end), end, min(at.z / last.anchor.w, 65000.0));
}

#else

layout(std430, binding = 7) readonly buffer Upper { float upper[]; };  // (view, Gaussian)
uniform uint gaussian_count;                                           // of the model
uniform uint remembers;                                                // 0: the last frame tells nothing of this one

// Eyes of a pair are views 2k and 2k + 1.
float upper_of(uint gaussian, uint view, Gaussian g, Splat splat) {
  if (remembers == 0u) return 1.0;
  float own = upper[view * gaussian_count + gaussian];
#if TRANSMITTANCE == TRANSMITTANCE_LAST
  return own;
#else
  float other = upper[(view ^ 1u) * gaussian_count + gaussian];
  return TRANSMITTANCE == TRANSMITTANCE_BOTH ? max(own, other) : other;
#endif
}

#endif
