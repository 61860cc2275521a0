// Access to the splats of a frame (slots.glsl): SPLAT(at), or with SPLATS_WRITTEN write_splat().
//   HALF             1: in half precision
//   WITH_SUBGROUPS   1: write_splat() uses subgroups
#if HALF
#include "halves.glsl"
#define SPLAT_PARTS 2u
#define SPLAT_PART uvec4
#else
#define SPLAT_PARTS 3u
#define SPLAT_PART vec4
#endif

#ifdef SPLATS_WRITTEN

layout(std430, binding = 12) writeonly buffer Splats { SPLAT_PART splats[]; };  // SPLAT_PARTS each

// Writes this invocation's splat, if it has one. All invocations must call it, neighbours with neighbouring places.
void write_splat(uint at, bool has_one, Splat splat) {
#if HALF
  if (has_one) {
    splats[SPLAT_PARTS * at] = packed_place(splat);
    splats[SPLAT_PARTS * at + 1u] = packed_shape(splat);
  }
#elif WITH_SUBGROUPS
  // Two neighbours write their two splats together, one splat after the other: each writes half of 32 bytes that lie in
  // one line of memory. This is faster than if each writes its own splat.
  bool is_even = gl_SubgroupInvocationID % 2u == 0u;
  bool is_first = at % 2u == 0u;  // whether these are a splat's first 32 bytes
  vec4 place = vec4(splat.mean, splat.depth, splat.opacity);
  vec4 low = is_first ? place : splat.conic, high = is_first ? splat.conic : splat.colour;
  vec4 got = subgroupShuffleXor(is_even ? high : low, 1u);
  bool other_has = subgroupShuffleXor(uint(has_one), 1u) != 0u;
  uint even = is_even ? at : at - 1u, odd = even + 1u;
  uint half_way = is_even ? 0u : 1u;
  if (is_even ? has_one : other_has) splats[SPLAT_PARTS * even + even % 2u + half_way] = is_even ? low : got;
  if (is_even ? other_has : has_one) splats[SPLAT_PARTS * odd + odd % 2u + half_way] = is_even ? got : high;
  if (has_one) splats[SPLAT_PARTS * at + (is_first ? 2u : 0u)] = is_first ? splat.colour : place;
#else
  if (has_one) {
    splats[SPLAT_PARTS * at] = vec4(splat.mean, splat.depth, splat.opacity);
    splats[SPLAT_PARTS * at + 1u] = splat.conic;
    splats[SPLAT_PARTS * at + 2u] = splat.colour;
  }
#endif
}

#elif HALF
layout(std430, binding = 12) readonly buffer Splats { uvec4 splats[]; };
#define SPLAT(at) unpack_splat(splats[SPLAT_PARTS * (at)], splats[SPLAT_PARTS * (at) + 1u])
#else
layout(std430, binding = 12) readonly buffer Splats { vec4 splats[]; };  // SPLAT_PARTS each
Splat read_splat(uint at) {
  vec4 place = splats[SPLAT_PARTS * at];
  return Splat(place.xy, place.z, place.w, splats[SPLAT_PARTS * at + 1u], splats[SPLAT_PARTS * at + 2u]);
}
#define SPLAT(at) read_splat(at)
#endif
