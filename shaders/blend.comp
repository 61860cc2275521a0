// Stage 6: the picture (METHOD 3). One work group a tile, an invocation COLUMN pixels one below the other; the tile's splats
// pass front to back through shared memory. Tiles with long lists are drawn by a launch of their own, which starts first and
// has more invocations (long_lists.comp).
//
// With SHOW, one of SHOW_ALPHAS to SHOW_LIGHT, it leaves the pictures as they are and tells what it comes by instead.
#include "shared/axes.h"
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"

layout(local_size_x = TILE_SIZE, local_size_y = TILE_SIZE / COLUMN) in;

#ifndef SHOW
#define SHOW SHOW_PICTURE
#endif
#define INVOCATIONS (TILE_SIZE * TILE_SIZE / COLUMN)
// Splats in shared memory at a time, 9 KiB at most: with more an H200 holds fewer groups, with less the longest lists take
// longer (src/render/README.md).
#if RECORDS || WEIGHS
#define BATCH_MAX 176
#else
#define BATCH_MAX 192
#endif
#define BATCH (INVOCATIONS < BATCH_MAX ? INVOCATIONS : BATCH_MAX)

layout(std430, binding = 0) readonly buffer Views { View views[]; };
layout(std430, binding = 1) readonly buffer Ranges { uint ranges[]; };
layout(std430, binding = 2) readonly buffer Values { uint values[]; };
layout(std430, binding = 3) readonly buffer Splats { Splat splats[]; };
layout(std430, binding = 4) buffer Colours { vec4 colours[]; };  // C, and T left
layout(std430, binding = 5) writeonly buffer ZSums { float z_sums[]; };
layout(std430, binding = 6) buffer FrameCounters { Counters counters; };
#if LONG_LISTS
layout(std430, binding = 9) readonly buffer LongLists { uint long_lists[]; };  // tiles
#endif
#if RECORDS || WEIGHS
layout(std430, binding = 7) buffer Measured { uint measured[]; };  // (view, slot): bits of floats, or two words of a sum
shared uint batch_measured[BATCH];
#endif
#if RECORDS
uniform uint remembers;  // whether `colours` still holds this view's last frame
#if CONTRAST != CONTRAST_OFF
uniform uint background_r, background_g, background_b;  // bits of floats
vec3 last[COLUMN];  // the pixel's colour in the last frame, background included
#endif
#endif
#if SHOW != SHOW_PICTURE
layout(std430, binding = 8) writeonly buffer Shown { float shown[]; };  // below 0: nothing to tell
float told[COLUMN];
#endif
#if SHOW == SHOW_LIGHT
layout(std430, binding = 7) readonly buffer Measured { uint measured[]; };  // by a blend with RECORDS before this one
shared float batch_light[BATCH];
#endif
uniform uint view_count;
uniform uint tile_count;
uniform uint list_per_view;  // 1 with --tiles all: a view's tiles share one list

// alpha = sigma 2^-|L^T d|^2, d = pixel - mean: L is the lower Cholesky factor of Q log2(e) / 2. Sums of Q's own products can
// turn negative, these squares cannot.
shared vec4 batch_place[BATCH];   // mean, L.xx, L.yx
shared vec2 batch_rest[BATCH];    // L.yy, opacity
shared vec4 batch_colour[BATCH];  // rgb, depth
shared uint alive;                // 1 while a pixel still takes light

vec2 pixel;  // the first of the column
uint size;   // splats of the batch
vec3 colour[COLUMN];
float z_sum[COLUMN];
float transmittance[COLUMN];  // 0 once the pixel is done,
float least[COLUMN];          // and this -T; until then the T that the blend stops at

// The most that a splat's alpha counts for in any pixel: T, times its contrast (METHOD 5, squared). A maximum in shared
// memory, and one a tile in the buffer, cost little beside the blend. Or what it counts for in all pixels together, as a
// whole number, so that the order of the additions does not matter.
void measure(uint at, uint p, float alpha) {
#if WEIGHS
  atomicAdd(batch_measured[at], uint(alpha * transmittance[p] * float(WEIGHT_SCALE) + 0.5));
#elif RECORDS
  float contrast = 1.0;
#if CONTRAST != CONTRAST_OFF
  vec3 other = last[p];
#if CONTRAST == CONTRAST_BEHIND
  // Of all that lies behind, as if it were seen without what is in front.
  other = (last[p] - colour[p] - alpha * transmittance[p] * batch_colour[at].rgb) / (transmittance[p] * (1.0 - alpha));
#endif
  vec3 d = batch_colour[at].rgb - other;
  if (remembers != 0u) contrast = min(1.0, sqrt(dot(d, d) / 3.0));
#endif
  atomicMax(batch_measured[at], floatBitsToUint(transmittance[p] * contrast));
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

bool is_done(uint p) { return least[p] < 0.0; }

bool are_done() {
  bool all = true;
  for (uint p = 0u; p < COLUMN; ++p) all = all && is_done(p);
  return all;
}

// AHEAD splats at once: their alphas do not wait for one another, only what they leave of T does.
void blend(uint at) {
  float alpha[AHEAD][COLUMN];
  for (uint k = 0u; k < AHEAD; ++k) {
    vec4 place = batch_place[at + k];
    vec2 rest = batch_rest[at + k];
    precise float dx = pixel.x - place.x;
    precise float x = place.z * dx;
    for (uint p = 0u; p < COLUMN; ++p) {
      precise float dy = pixel.y + float(p) - place.y;
      precise float u = fma(place.w, dy, x);
      precise float v = rest.x * dy;
      precise float square = fma(u, u, v * v);
      precise float a = min(float(ALPHA_MAX), rest.y * exp2(-square));
      alpha[k][p] = a >= float(ALPHA_MIN) ? a : 0.0;
    }
  }
  for (uint p = 0u; p < COLUMN; ++p) {
#if SHOW == SHOW_ALPHAS
    uint asked = min(uint(AHEAD), size - min(at, size));
    if (!is_done(p)) told[p] += float(asked);
#endif
    precise float left = transmittance[p];
    float weights[AHEAD];
    for (uint k = 0u; k < AHEAD; ++k) {
      precise float weight = alpha[k][p] * left;
      weights[k] = weight;
      left -= weight;
    }
    if (left < least[p]) {  // seldom: it stops at one of these
      left = transmittance[p];
      for (uint k = 0u; k < AHEAD; ++k) {
        precise float weight = alpha[k][p] * left;
        precise float next = left - weight;
        if (next < least[p]) {
          least[p] = -left;
#if SHOW == SHOW_ALPHAS
          told[p] -= float(asked - 1u - k);
#endif
        }
        weights[k] = is_done(p) ? 0.0 : weight;
        if (!is_done(p)) left = next;
      }
    }
    for (uint k = 0u; k < AHEAD; ++k) {
      vec4 c = batch_colour[at + k];
      float weight = weights[k];
#if RECORDS || WEIGHS
      if (weight > 0.0) measure(at + k, p, alpha[k][p]);
      transmittance[p] -= weight;
#endif
      precise float r = fma(weight, c.r, colour[p].r);
      precise float g = fma(weight, c.g, colour[p].g);
      precise float b = fma(weight, c.b, colour[p].b);
      precise float z = fma(weight, c.a, z_sum[p]);
#if SHOW == SHOW_VISIBLE
      if (weight > 0.0) told[p] += 1.0;
#elif SHOW == SHOW_LIGHT
      told[p] += weight * batch_light[at + k];
#endif
      colour[p] = vec3(r, g, b);
      z_sum[p] = z;
    }
    transmittance[p] = is_done(p) ? 0.0 : left;
  }
}

void load(uint at, uint end) {
  uint self = gl_LocalInvocationIndex;
  if (self >= BATCH) return;
#if RECORDS || WEIGHS
  batch_measured[self] = 0u;
#endif
  if (at >= end) {
    batch_place[self] = vec4(0.0);
    batch_rest[self] = vec2(0.0);
    batch_colour[self] = vec4(0.0);
    return;
  }
  Splat splat = splats[values[at]];
  const float scale = 0.72134752044448170;  // log2(e) / 2
  float xx = sqrt(scale * splat.conic.x);
  batch_place[self] = vec4(splat.mean, xx, scale * splat.conic.y / xx);
  batch_rest[self] = vec2(scale / (splat.conic.w * xx), splat.opacity);
  batch_colour[self] = vec4(splat.colour.rgb, splat.depth);
#if SHOW == SHOW_LIGHT
  batch_light[self] = uintBitsToFloat(measured[values[at]]);
#endif
}

uint view_of(uint tile) {
  uint v = 0u;
  while (v + 1u < view_count && tile >= views[v + 1u].tile_offset) ++v;
  return v;
}

void main() {
  // A frame that is to be drawn again must leave the last one's colours, which contrast is measured against.
  if (counters.overflow != 0u) return;
#if LONG_LISTS
  if (group_index() >= counters.long_lists) return;
  uint tile = long_lists[group_index()];
#else
  uint tile = group_index();
  if (tile >= tile_count) return;
#endif
  uint view_index = view_of(tile);
  View view = views[view_index];
  uint list = list_per_view != 0u ? view_index : tile;
  uint begin = ranges[2u * list];
  uint end = ranges[2u * list + 1u];
#if !LONG_LISTS
  if (end - begin > LONG_LIST && list_per_view == 0u) return;
#endif
  uint in_view = tile - view.tile_offset;
  uvec2 at = uvec2(in_view % view.tiles_x, in_view / view.tiles_x) * uint(TILE_SIZE) +
             gl_LocalInvocationID.xy * uvec2(1u, COLUMN);
  uint to = view.pixel_offset + at.y * view.width + at.x;
  pixel = vec2(at);
  for (uint p = 0u; p < COLUMN; ++p) {
    bool inside = at.x < view.width && at.y + p < view.height;
    colour[p] = vec3(0.0);
    z_sum[p] = 0.0;
    transmittance[p] = inside ? 1.0 : 0.0;
    least[p] = inside ? float(TRANSMITTANCE_MIN) : -1.0;
#if RECORDS && CONTRAST != CONTRAST_OFF
    last[p] = vec3(0.0);
    if (inside && remembers != 0u) {
      vec3 background = uintBitsToFloat(uvec3(background_r, background_g, background_b));
      last[p] = colours[to + p * view.width].rgb + colours[to + p * view.width].a * background;
    }
#endif
#if SHOW != SHOW_PICTURE
    told[p] = 0.0;
#endif
  }

  uint batch = begin;
  bool cut = false;
  for (; batch < end; batch += BATCH) {
    if (batch != begin) {
      if (gl_LocalInvocationIndex == 0u) alive = 0u;
      barrier();
      if (!are_done()) alive = 1u;
      barrier();
      if (alive == 0u) break;
    }
    load(batch + gl_LocalInvocationIndex, end);
    barrier();
    size = min(end - batch, uint(BATCH));
    uint next = 0u;
    for (; next < size && !are_done(); next += BLEND_UNROLL) {
      for (uint i = 0u; i < BLEND_UNROLL; i += AHEAD) blend(next + i);
    }
    cut = cut || (!are_done() && next < size);
#if RECORDS || WEIGHS
    barrier();
#endif
#if RECORDS || WEIGHS
    uint self = gl_LocalInvocationIndex;
    if (self < size && batch_measured[self] != 0u) pass_on(values[batch + self], batch_measured[self]);
#endif
  }
  if (cut || (!are_done() && batch < end)) atomicAdd(counters.loop_cut, 1u);
  for (uint p = 0u; p < COLUMN; ++p) {
    if (at.x >= view.width || at.y + p >= view.height) continue;
    float left = is_done(p) ? -least[p] : transmittance[p];
#if SHOW == SHOW_PAIRS
    told[p] = float(end - begin);
#elif SHOW == SHOW_LIGHT
    told[p] = left < 1.0 ? told[p] / (1.0 - left) : -1.0;
#endif
#if SHOW != SHOW_PICTURE
    shown[to + p * view.width] = told[p];
#else
    colours[to + p * view.width] = vec4(colour[p], left);
    z_sums[to + p * view.width] = z_sum[p];
#endif
  }
}
