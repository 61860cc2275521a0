// What both programs of stage 6 share: an invocation's pixels, and how splats are blended into them (docs/method.md 3).
//   COLUMN      pixels of an invocation, one below the other
//   AHEAD       splats whose alphas are found at once
//   BATCH       splats that the work group has in shared memory; the includer fills them by stage()
//   LISTS       LISTS_LONG: only tiles of more than LONG_LIST pairs; LISTS_SHORT: only the others
//   MEDIAN      1: a pixel's depth is the median of what is seen in it, else the mean; 2: at least of every second row
//   CANVASES    above 0: the pictures of so many views go into images, and z_sums are depths, 0 where there is none
//   ANY         whether something holds in an invocation that goes with this one
#include "shared/axes.h"
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "projection.glsl"
#include "supertiles.glsl"
#include "tiles/places.glsl"
#include "splats.glsl"  // binding 12

#define LISTS_SHORT 0
#define LISTS_LONG 1

#ifndef ANY
#define ANY(condition) (condition)
#endif

#ifndef SHOW
#define SHOW SHOW_PICTURE
#endif

layout(std430, binding = 0) readonly buffer Views { View views[]; };
layout(std430, binding = 1) readonly buffer Ranges { uint ranges[]; };
layout(std430, binding = 2) readonly buffer Values { uint values[]; };
#if CANVASES
#include "canvases.glsl"
#else
layout(std430, binding = 4) buffer Colours { vec4 colours[]; };  // C, and T left
#endif
layout(std430, binding = 5) writeonly buffer ZSums { float z_sums[]; };
layout(std430, binding = 6) buffer FrameCounters { Counters counters; };
#if LISTS == LISTS_LONG
layout(std430, binding = 9) readonly buffer LongLists { uint long_lists[]; };  // tiles
#endif
#if RECORDS
layout(std430, binding = 7) buffer Measured { uint measured[]; };  // by splat, bits of floats
#define MEASURED uint
shared uint batch_measured[BATCH];
#elif SUMS != SUMS_NONE
layout(std430, binding = 7) buffer Measured { uint measured[]; };  // by splat and channel, 64 bits, low first
#if SUMS == SUMS_TRANSPOSED
uniform uint scale;  // bits of a float
#endif
#define MEASURED ivec4
shared ivec4 batch_measured[BATCH];
vec4 picture[COLUMN];  // transposed: scaled
#endif
#if SHOW != SHOW_PICTURE
layout(std430, binding = 8) writeonly buffer Shown { float shown[]; };  // below 0: nothing to tell
float told[COLUMN];
#endif
#if SHOW == SHOW_LIGHT
layout(std430, binding = 7) readonly buffer Measured { uint measured[]; };  // by a blend with RECORDS before this one
shared float batch_light[BATCH];
#endif
#include "frame.glsl"

// -log2(alpha) in a pixel (x, y) of the cell is (t^2 + s) + y ((2 b t + v) + c y), t = a x + u. See stage(). With the tangent
// projection that is divided by |d|^2, d being the pixel's ray, before -log2(sigma), which is no part of s, is added.
shared vec4 batch_across[BATCH];  // a, u, 2 b, s
shared vec4 batch_down[BATCH];    // v, c, with the tangent projection -log2(sigma), and 0: one address finds all three
shared vec4 batch_colour[BATCH];  // rgb, depth

// What holds for all of a tile: with the tangent projection there are too few registers for it. All write the same.
#if PROJECTION == PROJECTION_TANGENT
#define OF_TILE shared
OF_TILE float farthest;  // the largest |d|^2
float nearness[COLUMN];  // of each pixel: 1 / |d|^2
#else
#define OF_TILE
#endif
OF_TILE vec2 middle;  // of its cell

uvec2 first_pixel;  // of the column
float column;       // from the middle of the cell
float row[COLUMN];  // of each pixel, as well
uint size;          // splats of the batch
vec3 colour[COLUMN];
float z_sum[COLUMN];
float transmittance[COLUMN];  // 0 once the pixel is done,
float least[COLUMN];          // and this -T; until then the T that the blend stops at

// The most that a splat's alpha counts for in any pixel: T (docs/method.md 5). A maximum in shared memory, and one a tile in
// the buffer, cost little beside the blend. Or sums over all pixels, in whole numbers, so that the order of the additions does
// not matter. The transposed blend: the picture, by what the splat counts for. Changes: without the splat alone, what lies
// behind it, of which it leaves the share 1 - alpha, is in its place.
void measure(uint at, uint p, float weight) {
#if SUMS != SUMS_NONE
#if SUMS == SUMS_TRANSPOSED
  ivec4 steps = ivec4(floor(weight * picture[p] + 0.5));
#else
  vec3 own = batch_colour[at].rgb;
  vec3 behind = (picture[p].rgb - colour[p] - weight * own) / (transmittance[p] - weight);
  vec3 change = weight * (behind - own);
  ivec4 steps = ivec4(min(dot(change, change), float(CHANGE_MOST)) * float(CHANGE_SCALE) + 0.5, 0.0, 0.0, 0.0);
#endif
  for (int c = 0; c < 4; ++c) {
    if (steps[c] != 0) atomicAdd(batch_measured[at][c], steps[c]);
  }
#elif RECORDS
  atomicMax(batch_measured[at], floatBitsToUint(transmittance[p]));
#endif
}

// The depth at which half of the light is gone; of the splats at hand some leave less than that.
float median_depth(uint at[AHEAD], float weights[AHEAD], float light) {
  for (uint k = 0u; k < AHEAD; ++k) {
    precise float left = light - weights[k];
    if (left < 1.0 - float(COVERAGE_FOR_DEPTH)) return batch_colour[at[k]].a;
    light = left;
  }
  return batch_colour[at[AHEAD - 1u]].a;
}

// What a tile measured of a splat, to the buffer.
#if SUMS != SUMS_NONE
void pass_on(uint splat, ivec4 sums) {
  for (uint c = 0u; c < 4u; ++c) {
    if (sums[c] == 0) continue;
    uint at = 2u * (4u * splat + c), sum = uint(sums[c]);
    uint before = atomicAdd(measured[at], sum);
    uint above = (sums[c] < 0 ? 0xffffffffu : 0u) + (before + sum < before ? 1u : 0u);
    if (above != 0u) atomicAdd(measured[at + 1u], above);
  }
}
#elif RECORDS
void pass_on(uint splat, uint most) {
  if (most != 0u) atomicMax(measured[splat], most);
}
#endif

bool is_done(uint p) { return least[p] < 0.0; }

bool are_done() {
  bool all = true;
  for (uint p = 0u; p < COLUMN; ++p) all = all && is_done(p);
  return all;
}

// AHEAD splats of the batch at once: their alphas do not wait for one another, only what they leave of T does.
void blend(uint at[AHEAD]) {
  float weights[COLUMN][AHEAD];  // alphas at first
  for (uint k = 0u; k < AHEAD; ++k) {
    vec4 across = batch_across[at[k]];
    vec4 down = batch_down[at[k]];
    precise float t = fma(across.x, column, across.y);
    precise float level = fma(t, t, across.w);
    precise float slope = fma(t, across.z, down.x);
    for (uint p = 0u; p < COLUMN; ++p) {
      precise float exponent = fma(row[p], fma(row[p], down.y, slope), level);
#if PROJECTION == PROJECTION_TANGENT
      exponent = fma(nearness[p], exponent, down.z);
#endif
      precise float a = exp2(-exponent);
      weights[p][k] = a >= float(ALPHA_MIN) ? min(float(ALPHA_MAX), a) : 0.0;  // not a number: 0
    }
  }
  float left[COLUMN];
  for (uint p = 0u; p < COLUMN; ++p) {
#if SHOW == SHOW_ALPHAS
    uint asked = min(uint(AHEAD), size - min(at[0], size));
    if (!is_done(p)) told[p] += float(asked);
#endif
    precise float next = transmittance[p];
    for (uint k = 0u; k < AHEAD; ++k) {
      precise float weight = weights[p][k] * next;
      weights[p][k] = weight;
      next -= weight;
    }
    left[p] = next;
    if (next < least[p]) {  // seldom: it stops before one of these
      next = transmittance[p];
      float last = next;
      for (uint k = 0u; k < AHEAD; ++k) {
        next -= weights[p][k];
        bool is_kept = next >= least[p];
        weights[p][k] = is_kept ? weights[p][k] : 0.0;
        last = is_kept ? next : last;
#if SHOW == SHOW_ALPHAS
        told[p] += float(is_kept);
#endif
      }
#if SHOW == SHOW_ALPHAS
      told[p] -= float(asked - 1u);
#endif
      least[p] = -last;
      left[p] = 0.0;
    }
#if MEDIAN
    const float half_light = 1.0 - float(COVERAGE_FOR_DEPTH);
    bool is_half = transmittance[p] >= half_light && left[p] < half_light;
    if ((MEDIAN == 1 || p % 2u == 0u) && ANY(is_half)) {  // seldom
      float depth = median_depth(at, weights[p], transmittance[p]);
      if (is_half) z_sum[p] = depth;
    }
#endif
  }
  for (uint k = 0u; k < AHEAD; ++k) {
    vec4 c = batch_colour[at[k]];
    for (uint p = 0u; p < COLUMN; ++p) {
      float weight = weights[p][k];
#if RECORDS || SUMS != SUMS_NONE
      if (weight > 0.0) measure(at[k], p, weight);
      transmittance[p] -= weight;
#elif SHOW == SHOW_MEDIAN_DEPTH
      transmittance[p] -= weight;
      if (told[p] < 0.0 && weight > 0.0 && transmittance[p] < 1.0 - float(COVERAGE_FOR_DEPTH)) told[p] = c.a;
#endif
      precise float r = fma(weight, c.r, colour[p].r);
      precise float g = fma(weight, c.g, colour[p].g);
      precise float b = fma(weight, c.b, colour[p].b);
#if !MEDIAN
      precise float z = fma(weight, c.a, z_sum[p]);
      z_sum[p] = z;
#endif
#if SHOW == SHOW_VISIBLE
      if (weight > 0.0) told[p] += 1.0;
#elif SHOW == SHOW_LIGHT
      told[p] += weight * batch_light[at[k]];
#endif
      colour[p] = vec3(r, g, b);
    }
  }
  for (uint p = 0u; p < COLUMN; ++p) transmittance[p] = left[p];
}

// Those that follow one another.
void blend_from(uint first) {
  uint at[AHEAD];
  for (uint k = 0u; k < AHEAD; ++k) at[k] = first + k;
  blend(at);
}

// A splat for the batch, and one that leaves no mark.
//
// alpha = sigma 2^-|L^T d|^2, d = pixel - mean, L the lower Cholesky factor of Q log2(e) / 2, as a polynomial of the pixel's
// place from the middle of its cell. No splat is thinner than the low-pass, and where alpha can be seen the mean is no further
// than a few of its widths: no term is large there, and their sum exact to 1e-4. Cells do not depend on the tiles' size.
void stage(uint at, Splat splat) {
  const float scale = 0.72134752044448170;  // log2(e) / 2
  batch_colour[at] = vec4(splat.colour.rgb, abs(splat.depth));
  precise vec2 mean = splat.mean - middle;
  precise float xx = sqrt(scale * splat.conic.x);
  precise float yx = scale * splat.conic.y / xx;
  precise float yy = scale / (abs(splat.conic.w) * xx);
  precise float u = -fma(xx, mean.x, yx * mean.y);
  precise float v = -yy * mean.y;
  precise float bits = splat.opacity >= float(ALPHA_MIN) ? log2(splat.opacity) : -1e30;
  precise float slope = 2.0 * v * yy;
  precise float bend = fma(yx, yx, yy * yy);
#if PROJECTION == PROJECTION_TANGENT
  batch_across[at] = vec4(xx, u, 2.0 * yx, v * v);
  batch_down[at] = vec4(slope, bend, -bits, 0.0);
#else
  precise float level = fma(v, v, -bits);
  batch_across[at] = vec4(xx, u, 2.0 * yx, level);
  batch_down[at] = vec4(slope, bend, 0.0, 0.0);
#endif
}

void stage_nothing(uint at) {
  batch_across[at] = vec4(0.0, 0.0, 0.0, 1e30);
  batch_down[at] = vec4(0.0);
  batch_colour[at] = vec4(0.0);
}

// What the work group draws.
uint tile = 0u;
uint view_index = 0u;
uint begin = 0u, end = 0u;  // its list

// Whether there is anything for this work group to draw; else it must end.
bool find_tile() {
  // It is to be drawn again.
  if (counters.overflow != 0u) return false;
#if LISTS == LISTS_LONG
  if (group_index() >= counters.long_lists) return false;
  tile = long_lists[group_index()];
#else
  tile = group_index();
  if (tile >= frame.tile_count) return false;
#endif
  while (view_index + 1u < frame.view_count && tile >= views[view_index + 1u].supertile_offset * SUPERTILE_TILES) ++view_index;
  uint list = frame.list_per_view != 0u ? view_index : tile;
  begin = ranges[2u * list];
  end = ranges[2u * list + 1u];
  bool is_own = LISTS != LISTS_SHORT || end - begin <= LONG_LIST || frame.list_per_view != 0u;
#if PARTS
  if (!is_drawn(tile_of(tile, views[view_index]), views[view_index])) end = begin;
#endif
  return is_own;
}

// Where pixel p of this invocation is kept. A probe's tiles are kept side by side.
uint place_of(View view, uint p) {
  uvec2 at = first_pixel - first_drawn(view);
  uint across = view.width;
  if (is_probe(view)) {
    uvec2 in_grid = tile_of(tile, view);
    at += in_grid * uint(TILE_SIZE) - tile_corner(in_grid, view);
    across = view.tiles_x * uint(TILE_SIZE);
  }
  return view.pixel_offset + (at.y + p) * across + at.x;
}

// The pixels of this invocation, of which the first lies `in_tile`.
void begin_pixels(uvec2 in_tile) {
  View view = views[view_index];
  uvec2 corner = tile_corner(tile_of(tile, view), view);
  middle = vec2(corner / BLEND_CELL * BLEND_CELL) + 0.5 * float(BLEND_CELL - 1u);
  first_pixel = corner + in_tile;
  column = float(first_pixel.x) - middle.x;
#if PROJECTION == PROJECTION_TANGENT
  precise vec2 step = 1.0 / view.lens.xy;
  vec2 first = (vec2(corner) + 0.5 - view.lens.zw) * step;
  vec2 most = max(abs(first), abs(first + float(TILE_SIZE - 1) * step));
  farthest = 1.0 + dot(most, most);
#endif
  for (uint p = 0u; p < COLUMN; ++p) {
    bool inside = first_pixel.x <= last_drawn(view).x && first_pixel.y + p <= last_drawn(view).y;
    row[p] = float(first_pixel.y + p) - middle.y;
    colour[p] = vec3(0.0);
    z_sum[p] = 0.0;
    transmittance[p] = inside ? 1.0 : 0.0;
#if PROJECTION == PROJECTION_TANGENT
    precise vec2 ray = (vec2(first_pixel + uvec2(0u, p)) + 0.5 - view.lens.zw) * step;
    precise float inverse = 1.0 / fma(ray.y, ray.y, fma(ray.x, ray.x, 1.0));
    nearness[p] = inverse;
#endif
    least[p] = inside ? float(TRANSMITTANCE_MIN) : -1.0;
#if SUMS != SUMS_NONE
    picture[p] = inside ? colours[place_of(view, p)] : vec4(0.0);
#endif
#if SUMS == SUMS_TRANSPOSED
    picture[p] *= uintBitsToFloat(scale);
#endif
#if SHOW != SHOW_PICTURE
    told[p] = SHOW == SHOW_MEDIAN_DEPTH ? -1.0 : 0.0;
#endif
  }
}

void write_pixels() {
  View view = views[view_index];
  for (uint p = 0u; p < COLUMN; ++p) {
    if (first_pixel.x > last_drawn(view).x || first_pixel.y + p > last_drawn(view).y) continue;
    uint to = place_of(view, p);
    float left = is_done(p) ? -least[p] : transmittance[p];
#if SHOW == SHOW_PAIRS
    told[p] = float(end - begin);
#elif SHOW == SHOW_LIGHT
    told[p] = left < 1.0 ? told[p] / (1.0 - left) : -1.0;
#elif SHOW == SHOW_MEDIAN_DEPTH && PROJECTION == PROJECTION_TANGENT
    told[p] *= sqrt(nearness[p]);  // of a distance
#endif
#if SHOW != SHOW_PICTURE
    shown[to] = told[p];
#else
#if CANVASES
    uvec2 at = first_pixel + uvec2(0u, p) - first_drawn(view);
    write_on_canvas(view_index, canvases[view_index], view.height, at, vec4(colour[p], left), frame.background.rgb);
#else
    colours[to] = vec4(colour[p], left);
#endif
#if PROJECTION == PROJECTION_TANGENT
    precise float along = z_sum[p] * sqrt(nearness[p]);  // of distances
    z_sum[p] = along;
#endif
#if CANVASES
    if (left >= 1.0 - float(COVERAGE_FOR_DEPTH)) z_sum[p] = 0.0;
#if !MEDIAN
    else z_sum[p] /= 1.0 - left;
#endif
#elif MEDIAN
    precise float cover = 1.0 - left;
    precise float z = z_sum[p] * cover;
    z_sum[p] = z;
#endif
#if MEDIAN == 2
    if (p % 2u != 0u) continue;
#endif
    z_sums[to] = z_sum[p];
#endif
  }
}
