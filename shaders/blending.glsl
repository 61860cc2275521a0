// What both programs of stage 6 share: an invocation's pixels, and how splats are blended into them (METHOD 3).
//   COLUMN      pixels of an invocation, one below the other
//   AHEAD       splats whose alphas are found at once
//   BATCH       splats that the work group has in shared memory; the includer fills them by stage()
//   LONG_LISTS  1: only tiles of more than LONG_LIST pairs; 0: only the others
#include "shared/axes.h"
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"

#ifndef SHOW
#define SHOW SHOW_PICTURE
#endif

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

uvec2 first_pixel;  // of the column
vec2 pixel;         // the same
uint size;          // splats of the batch
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

// A splat for the batch, and one that leaves no mark.
void stage(uint at, Splat splat) {
  const float scale = 0.72134752044448170;  // log2(e) / 2
  float xx = sqrt(scale * splat.conic.x);
  batch_place[at] = vec4(splat.mean, xx, scale * splat.conic.y / xx);
  batch_rest[at] = vec2(scale / (splat.conic.w * xx), splat.opacity);
  batch_colour[at] = vec4(splat.colour.rgb, splat.depth);
}

void stage_nothing(uint at) {
  batch_place[at] = vec4(0.0);
  batch_rest[at] = vec2(0.0);
  batch_colour[at] = vec4(0.0);
}

// What the work group draws.
uint tile = 0u;
uint view_index = 0u;
uint begin = 0u, end = 0u;  // its list

// Whether there is anything for this work group to draw; else it must end.
bool find_tile() {
  // A frame that is to be drawn again must leave the last one's colours, which contrast is measured against.
  if (counters.overflow != 0u) return false;
#if LONG_LISTS
  if (group_index() >= counters.long_lists) return false;
  tile = long_lists[group_index()];
#else
  tile = group_index();
  if (tile >= tile_count) return false;
#endif
  while (view_index + 1u < view_count && tile >= views[view_index + 1u].tile_offset) ++view_index;
  uint list = list_per_view != 0u ? view_index : tile;
  begin = ranges[2u * list];
  end = ranges[2u * list + 1u];
  return LONG_LISTS != 0 || end - begin <= LONG_LIST || list_per_view != 0u;
}

// The pixels of this invocation, of which the first lies `in_tile`.
void begin_pixels(uvec2 in_tile) {
  View view = views[view_index];
  uint nth = tile - view.tile_offset;
  first_pixel = uvec2(nth % view.tiles_x, nth / view.tiles_x) * uint(TILE_SIZE) + in_tile;
  pixel = vec2(first_pixel);
  for (uint p = 0u; p < COLUMN; ++p) {
    bool inside = first_pixel.x < view.width && first_pixel.y + p < view.height;
    colour[p] = vec3(0.0);
    z_sum[p] = 0.0;
    transmittance[p] = inside ? 1.0 : 0.0;
    least[p] = inside ? float(TRANSMITTANCE_MIN) : -1.0;
#if RECORDS && CONTRAST != CONTRAST_OFF
    last[p] = vec3(0.0);
    if (inside && remembers != 0u) {
      uint from = view.pixel_offset + (first_pixel.y + p) * view.width + first_pixel.x;
      vec3 background = uintBitsToFloat(uvec3(background_r, background_g, background_b));
      last[p] = colours[from].rgb + colours[from].a * background;
    }
#endif
#if SHOW != SHOW_PICTURE
    told[p] = 0.0;
#endif
  }
}

void write_pixels() {
  View view = views[view_index];
  for (uint p = 0u; p < COLUMN; ++p) {
    if (first_pixel.x >= view.width || first_pixel.y + p >= view.height) continue;
    uint to = view.pixel_offset + (first_pixel.y + p) * view.width + first_pixel.x;
    float left = is_done(p) ? -least[p] : transmittance[p];
#if SHOW == SHOW_PAIRS
    told[p] = float(end - begin);
#elif SHOW == SHOW_LIGHT
    told[p] = left < 1.0 ? told[p] / (1.0 - left) : -1.0;
#endif
#if SHOW != SHOW_PICTURE
    shown[to] = told[p];
#else
    colours[to] = vec4(colour[p], left);
    z_sums[to] = z_sum[p];
#endif
  }
}
