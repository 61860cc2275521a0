// write_splat() writes this invocation's splat, if it has one, for SPLAT() of splats.glsl. All invocations must call it,
// neighbours with neighbouring places (splat_places.glsl).
//   HALF             1: in half precision
//   WITH_SUBGROUPS   1: neighbours write together
#if HALF
#include "half_precision.glsl"
layout(std430, binding = 12) writeonly buffer Splats { uvec4 splats[]; };  // two each

void write_splat(uint at, bool has_one, Splat splat) {
  if (has_one) {
    splats[2u * at] = packed_place(splat);
    splats[2u * at + 1u] = packed_shape(splat);
  }
}

#else
layout(std430, binding = 12) writeonly buffer Splats { vec4 splats[]; };  // three each

void write_splat(uint at, bool has_one, Splat splat) {
  vec4 place = vec4(splat.mean, splat.depth, splat.opacity);
#if WITH_SUBGROUPS
  // Two neighbours write their two splats together, one splat after the other: each writes half of 32 bytes that lie in
  // one line of memory. This is faster than if each writes its own splat.
  bool is_even = gl_SubgroupInvocationID % 2u == 0u;
  bool is_first = at % 2u == 0u;  // whether these are a splat's first 32 bytes
  vec4 low = is_first ? place : splat.conic, high = is_first ? splat.conic : splat.colour;
  vec4 got = subgroupShuffleXor(is_even ? high : low, 1u);
  bool other_has = subgroupShuffleXor(uint(has_one), 1u) != 0u;
  uint even = is_even ? at : at - 1u, odd = even + 1u;
  uint half_way = is_even ? 0u : 1u;
  if (is_even ? has_one : other_has) splats[3u * even + even % 2u + half_way] = is_even ? low : got;
  if (is_even ? other_has : has_one) splats[3u * odd + odd % 2u + half_way] = is_even ? got : high;
  if (has_one) splats[3u * at + (is_first ? 2u : 0u)] = is_first ? splat.colour : place;
#else
  if (has_one) {
    splats[3u * at] = place;
    splats[3u * at + 1u] = splat.conic;
    splats[3u * at + 2u] = splat.colour;
  }
#endif
}
#endif
