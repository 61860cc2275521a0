// Stage 6: the picture (METHOD 3). One work group a tile, one invocation a pixel; the tile's splats pass front to back
// through shared memory.
//
// With SHOW, one of SHOW_ALPHAS to SHOW_LIGHT, it leaves the pictures as they are and tells what it comes by instead.
#include "shared/axes.h"
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"

layout(local_size_x = TILE_SIZE, local_size_y = TILE_SIZE) in;

#ifndef SHOW
#define SHOW SHOW_PICTURE
#endif
#define PIXELS (TILE_SIZE * TILE_SIZE)
// Splats in shared memory at a time, 9 KiB at most: with more an H200 holds fewer groups, with less the longest lists take
// longer (src/render/README.md).
#if RECORDS || WEIGHS
#define BATCH_MAX 176
#else
#define BATCH_MAX 192
#endif
#define BATCH (PIXELS < BATCH_MAX ? PIXELS : BATCH_MAX)

layout(std430, binding = 0) readonly buffer Views { View views[]; };
layout(std430, binding = 1) readonly buffer Ranges { uint ranges[]; };
layout(std430, binding = 2) readonly buffer Values { uint values[]; };
layout(std430, binding = 3) readonly buffer Splats { Splat splats[]; };
layout(std430, binding = 4) buffer Colours { vec4 colours[]; };  // C, and T left
layout(std430, binding = 5) writeonly buffer ZSums { float z_sums[]; };
layout(std430, binding = 6) buffer FrameCounters { Counters counters; };
#if RECORDS || WEIGHS
layout(std430, binding = 7) buffer Measured { uint measured[]; };  // (view, slot): bits of floats, or two words of a sum
shared uint batch_measured[BATCH];
#endif
#if RECORDS
uniform uint remembers;  // whether `colours` still holds this view's last frame
#if CONTRAST != CONTRAST_OFF
uniform uint background_r, background_g, background_b;  // bits of floats
#endif
#endif
#if SHOW != SHOW_PICTURE
layout(std430, binding = 8) writeonly buffer Shown { float shown[]; };  // below 0: nothing to tell
float told = 0.0;
#endif
#if SHOW == SHOW_LIGHT
layout(std430, binding = 7) readonly buffer Measured { uint measured[]; };  // by a blend with RECORDS before this one
shared float batch_light[BATCH];
#endif
uniform uint view_count;
uniform uint tile_count;
uniform uint list_per_view;  // 1 with --tiles all: a view's tiles share one list

shared vec4 batch_geometry[BATCH];  // mean, depth, opacity
shared vec4 batch_conic[BATCH];
shared vec4 batch_colour[BATCH];
shared uint alive;  // pixels that still take light

vec2 pixel;
vec3 colour = vec3(0.0);
float z_sum = 0.0;
float transmittance = 1.0;
bool done = false;
vec3 last = vec3(0.0);  // the pixel's colour in the last frame, background included

// The most that a splat's alpha counts for in any pixel: T, times its contrast (METHOD 5, squared). A maximum in shared
// memory, and one a tile in the buffer, cost little beside the blend. Or what it counts for in all pixels together, as a
// whole number, so that the order of the additions does not matter.
void measure(uint at, float alpha) {
#if WEIGHS
  atomicAdd(batch_measured[at], uint(alpha * transmittance * float(WEIGHT_SCALE) + 0.5));
#elif RECORDS
  float contrast = 1.0;
#if CONTRAST != CONTRAST_OFF
  vec3 other = last;
#if CONTRAST == CONTRAST_BEHIND
  // Of all that lies behind, as if it were seen without what is in front.
  other = (last - colour - alpha * transmittance * batch_colour[at].rgb) / (transmittance * (1.0 - alpha));
#endif
  vec3 d = batch_colour[at].rgb - other;
  if (remembers != 0u) contrast = min(1.0, sqrt(dot(d, d) / 3.0));
#endif
  atomicMax(batch_measured[at], floatBitsToUint(transmittance * contrast));
#endif
}

// What a tile measured of a splat, to the buffer.
#if WEIGHS
void pass_on(uint splat, uint sum) {
  uint before = atomicAdd(measured[2u * splat], sum);
  if (before + sum < before) atomicAdd(measured[2u * splat + 1u], 1u);
}
#elif RECORDS
void pass_on(uint splat, uint most) { atomicMax(measured[splat], most); }
#endif

void blend(uint at) {
  vec4 geometry = batch_geometry[at];
  vec4 conic = batch_conic[at];
  precise vec2 d = pixel - geometry.xy;
  precise float q = conic.x * d.x * d.x + 2.0 * conic.y * d.x * d.y + conic.z * d.y * d.y;
  precise float alpha = min(float(ALPHA_MAX), geometry.w * exp2(-0.72134752044448170 * q));
  if (done || q < 0.0 || !(alpha >= float(ALPHA_MIN))) return;
  precise float left = transmittance * (1.0 - alpha);
  if (left < float(TRANSMITTANCE_MIN)) {
    done = true;
    return;
  }
  measure(at, alpha);
  precise float weight = alpha * transmittance;
#if SHOW == SHOW_VISIBLE
  told += 1.0;
#elif SHOW == SHOW_LIGHT
  told += weight * batch_light[at];
#endif
  precise vec3 sum = colour + weight * batch_colour[at].rgb;
  precise float z = z_sum + weight * geometry.z;
  colour = sum;
  z_sum = z;
  transmittance = left;
}

void load(uint at, uint end) {
  uint self = gl_LocalInvocationIndex;
  if (self >= BATCH) return;
#if RECORDS || WEIGHS
  batch_measured[self] = 0u;
#endif
  if (at < end) {
    Splat splat = splats[values[at]];
    batch_geometry[self] = vec4(splat.mean, splat.depth, splat.opacity);
    batch_conic[self] = splat.conic;
    batch_colour[self] = splat.colour;
#if SHOW == SHOW_LIGHT
    batch_light[self] = uintBitsToFloat(measured[values[at]]);
#endif
  } else {
    batch_geometry[self] = vec4(0.0);  // no opacity: leaves no mark
    batch_conic[self] = vec4(0.0);
    batch_colour[self] = vec4(0.0);
  }
}

uint view_of(uint tile) {
  uint v = 0u;
  while (v + 1u < view_count && tile >= views[v + 1u].tile_offset) ++v;
  return v;
}

void main() {
  uint tile = group_index();
  // A frame that is to be drawn again must leave the last one's colours, which contrast is measured against.
  if (tile >= tile_count || counters.overflow != 0u) return;
  uint view_index = view_of(tile);
  View view = views[view_index];
  uint in_view = tile - view.tile_offset;
  uvec2 at = uvec2(in_view % view.tiles_x, in_view / view.tiles_x) * uint(TILE_SIZE) + gl_LocalInvocationID.xy;
  pixel = vec2(at);
  bool inside = at.x < view.width && at.y < view.height;
  done = !inside;
  uint to = view.pixel_offset + at.y * view.width + at.x;
#if RECORDS && CONTRAST != CONTRAST_OFF
  if (inside && remembers != 0u) {
    vec3 background = uintBitsToFloat(uvec3(background_r, background_g, background_b));
    last = colours[to].rgb + colours[to].a * background;
  }
#endif

  uint list = list_per_view != 0u ? view_index : tile;
  uint end = ranges[2u * list + 1u];
  uint batch = ranges[2u * list];
  bool cut = false;
  for (; batch < end; batch += BATCH) {
    if (gl_LocalInvocationIndex == 0u) alive = 0u;
    barrier();
    if (!done) atomicAdd(alive, 1u);
    load(batch + gl_LocalInvocationIndex, end);
    barrier();
    if (alive == 0u) break;
    uint size = min(end - batch, uint(BATCH));
    uint next = 0u;
    for (; next < size && !done; next += BLEND_UNROLL) {
      for (uint i = 0u; i < BLEND_UNROLL; ++i) {
#if SHOW == SHOW_ALPHAS
        if (!done && next + i < size) told += 1.0;
#endif
        blend(next + i);
      }
    }
    cut = cut || (!done && next < size);
    barrier();
#if RECORDS || WEIGHS
    uint self = gl_LocalInvocationIndex;
    if (self < size && batch_measured[self] != 0u) pass_on(values[batch + self], batch_measured[self]);
#endif
  }
  if (cut || (!done && batch < end)) atomicAdd(counters.loop_cut, 1u);
#if SHOW == SHOW_PAIRS
  told = float(end - ranges[2u * list]);
#elif SHOW == SHOW_LIGHT
  told = transmittance < 1.0 ? told / (1.0 - transmittance) : -1.0;
#endif
  if (inside) {
#if SHOW != SHOW_PICTURE
    shown[to] = told;
#else
    colours[to] = vec4(colour, transmittance);
    z_sums[to] = z_sum;
#endif
  }
}
