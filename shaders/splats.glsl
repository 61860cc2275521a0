// The splats of a frame, (slot, view): SPLAT(at), or with SPLATS_WRITTEN write_splat().
//   HALF   1: in half precision
#ifdef SPLATS_WRITTEN
#define SPLATS_ACCESS writeonly
#else
#define SPLATS_ACCESS readonly
#endif

#if HALF
#include "halves.glsl"
layout(std430, binding = 12) SPLATS_ACCESS buffer Splats { uvec4 splats[]; };  // two each
#define SPLAT(at) unpack_splat(splats[2u * (at)], splats[2u * (at) + 1u])
#else
layout(std430, binding = 12) SPLATS_ACCESS buffer Splats { Splat splats[]; };
#define SPLAT(at) splats[at]
#endif

#ifdef SPLATS_WRITTEN
void write_splat(uint at, Splat splat) {
#if HALF
  splats[2u * at] = packed_place(splat);
  splats[2u * at + 1u] = packed_shape(splat);
#else
  splats[at] = splat;
#endif
}
#endif
