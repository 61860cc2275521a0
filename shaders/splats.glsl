// SPLAT(at): a splat of the frame (splat_places.glsl).
//   HALF   1: in half precision
#if HALF
#include "half_precision.glsl"
layout(std430, binding = 12) readonly buffer Splats { uvec4 splats[]; };  // two each
#define SPLAT(at) unpack_splat(splats[2u * (at)], splats[2u * (at) + 1u])
#else
layout(std430, binding = 12) readonly buffer Splats { vec4 splats[]; };  // three each
Splat read_splat(uint at) {
  vec4 place = splats[3u * at];
  return Splat(place.xy, place.z, place.w, splats[3u * at + 1u], splats[3u * at + 2u]);
}
#define SPLAT(at) read_splat(at)
#endif
