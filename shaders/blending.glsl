// What both programs of stage 6 share: an invocation's pixels, and how splats are blended into them (docs/method.md 3).
//   COLUMN      pixels of an invocation, one below the other
//   AHEAD       splats whose alphas are found at once
//   BATCH       splats that the work group has in shared memory; the includer fills them by stage()
//   LISTS       LISTS_LONG: only tiles of more than LONG_LIST pairs; LISTS_SHORT: only the others
//   DEPTH       what z_sums tell, DEPTH_ of shared/limits.h
//   LOSSY       1: th squared with the lists of ellipses, by which a splat is blended in the blocks where its alpha reaches Th,
//               and a block ends once it is dark (docs/method.md 5.2)
//   CANVASES    above 0: the pictures of so many views go into images, and z_sums are depths, 0 where there is none
//   ANY         whether something holds in an invocation that goes with this one
//   REACHES     whether a splat of the batch is blended in this invocation's block, if others are in the batch, too
#include "lists.glsl"
#include "shared/axes.h"
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "projection.glsl"
#include "supertiles.glsl"
#include "tiles/places.glsl"
#include "splats.glsl"  // binding 12

#ifndef ANY
#define ANY(condition) (condition)
#endif

#ifndef REACHES
#define REACHES(at) true
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
#if DEPTH != DEPTH_NONE
layout(std430, binding = 5) writeonly buffer ZSums { float z_sums[]; };
#endif
layout(std430, binding = 6) buffer FrameCounters { Counters counters; };
#if LISTS == LISTS_LONG
layout(std430, binding = 9) readonly buffer LongLists { uint long_lists[]; };  // tiles
#endif
#if RECORDS
layout(std430, binding = 7) buffer Measured { uint measured[]; };  // by splat, bits of floats
#define MEASURED uint
shared uint batch_measured[BATCH];
#elif SUMS != SUMS_NONE
// By splat and channel, 64 bits, low first. Seen: by splat, SEEN_LOW_BITS and those above.
layout(std430, binding = 7) buffer Measured { uint measured[]; };
#if SUMS == SUMS_TRANSPOSED
uniform uint scale;  // bits of a float
#endif
#if SUMS == SUMS_SEEN
#define MEASURED int
#else
#define MEASURED ivec4
vec4 picture[COLUMN];  // transposed: scaled
#endif
shared MEASURED batch_measured[BATCH];
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
// behind it, of which it leaves the share 1 - alpha, is in its place. Seen: what an error of its colour would count for,
// alpha T, times the T that an error of its alpha would (blend()).
void measure(uint at, uint p, float weight) {
#if SUMS == SUMS_TRANSPOSED || SUMS == SUMS_CHANGES
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
#if SUMS == SUMS_SEEN
// In two parts without a carry, for which one would wait: there is room for 2^26 px, and for 2^18 tiles, in a look that is
// half as large as a picture or less.
void pass_on(uint splat, int sum) {
  uint low = uint(sum) & ((1u << SEEN_LOW_BITS) - 1u), high = uint(sum) >> SEEN_LOW_BITS;
  if (low != 0u) atomicAdd(measured[2u * splat], low);
  if (high != 0u) atomicAdd(measured[2u * splat + 1u], high);
}
#elif SUMS != SUMS_NONE
void pass_on(uint splat, ivec4 sums) {
  for (uint c = 0u; c < 4u; ++c) {
    int sum = sums[c];
    if (sum == 0) continue;
    uint at = 2u * (4u * splat + c);
    uint before = atomicAdd(measured[at], uint(sum));
    uint above = (sum < 0 ? 0xffffffffu : 0u) + (before + uint(sum) < before ? 1u : 0u);
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

float light_left(uint p) { return is_done(p) ? -least[p] : transmittance[p]; }

#if LOSSY
float last_light;         // T at most of the pixels of a dark block
bool ended_dark = false;  // this block, before its list did
#if RECORDS
vec4 dark_colour[COLUMN];  // with Z; what measures goes on behind
float dark_left[COLUMN];
#endif

bool are_dark() {
  bool all = true;
  for (uint p = 0u; p < COLUMN; ++p) all = all && transmittance[p] <= last_light;
  return all;
}

// What is behind is taken to look as what was seen, but in pixels that have ended by themselves.
void end_dark() {
  if (ended_dark || last_light <= 0.0) return;
  ended_dark = true;
  for (uint p = 0u; p < COLUMN; ++p) {
    precise float scale = is_done(p) ? 1.0 : 1.0 / (1.0 - transmittance[p]);
    colour[p] *= scale;
    z_sum[p] *= DEPTH == DEPTH_MEAN ? scale : 1.0;
#if SHOW == SHOW_LIGHT
    told[p] *= scale;
#endif
#if RECORDS
    dark_colour[p] = vec4(colour[p], z_sum[p]);
    dark_left[p] = is_done(p) ? light_left(p) : 0.0;
#endif
  }
}
#define TAKES_NO_MORE (ended_dark && RECORDS == 0)
#else
#define are_dark are_done
#define TAKES_NO_MORE false
#endif

// AHEAD splats of the batch at once: their alphas do not wait for one another, only what they leave of T does.
void blend(uint at[AHEAD]) {
  float weights[COLUMN][AHEAD];  // alphas at first
#if RECORDS && LOSSY
  bool is_met[COLUMN][AHEAD];  // in a pixel, if not in its block
#define IS_MET(p, k) is_met[p][k]
#else
#define IS_MET(p, k) (weights[p][k] > 0.0)
#endif
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
      weights[p][k] = a >= float(ALPHA_MIN) && REACHES(at[k]) ? min(float(ALPHA_MAX), a) : 0.0;  // not a number: 0
#if RECORDS && LOSSY
      is_met[p][k] = a >= float(ALPHA_MIN);
#endif
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
#if DEPTH >= DEPTH_MEDIAN
    const float half_light = 1.0 - float(COVERAGE_FOR_DEPTH);
    bool is_half = transmittance[p] >= half_light && left[p] < half_light;
    if ((DEPTH == DEPTH_MEDIAN || p % 2u == 0u) && ANY(is_half)) {  // seldom
      float depth = median_depth(at, weights[p], transmittance[p]);
      if (is_half) z_sum[p] = depth;
    }
#endif
  }
  for (uint k = 0u; k < AHEAD; ++k) {
    vec4 c = batch_colour[at[k]];
#if SUMS == SUMS_SEEN
    int seen = 0;
#endif
    for (uint p = 0u; p < COLUMN; ++p) {
      float weight = weights[p][k];
#if DEPTH == DEPTH_SEEN
      z_sum[p] += weight * transmittance[p];
#endif
#if SUMS == SUMS_SEEN
      float counted = transmittance[p] >= float(SEEN_LEAST) ? weight * transmittance[p] : 0.0;
      seen += int(floor(counted * float(SEEN_SCALE) + 0.5));
      transmittance[p] -= weight;
#elif RECORDS || SUMS != SUMS_NONE
      if (IS_MET(p, k)) measure(at[k], p, weight);
      transmittance[p] -= weight;
#elif DEPTH == DEPTH_SEEN
      transmittance[p] -= weight;
#elif SHOW == SHOW_MEDIAN_DEPTH
      transmittance[p] -= weight;
      if (told[p] < 0.0 && weight > 0.0 && transmittance[p] < 1.0 - float(COVERAGE_FOR_DEPTH)) told[p] = c.a;
#endif
      precise float r = fma(weight, c.r, colour[p].r);
      precise float g = fma(weight, c.g, colour[p].g);
      precise float b = fma(weight, c.b, colour[p].b);
#if DEPTH == DEPTH_MEAN
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
#if SUMS == SUMS_SEEN
    if (seen != 0) atomicAdd(batch_measured[at[k]], seen);
#endif
  }
  for (uint p = 0u; p < COLUMN; ++p) {
    transmittance[p] = left[p];
#if SUMS == SUMS_SEEN
    if (left[p] < float(SEEN_LEAST) && !is_done(p)) {
      least[p] = -left[p];
      transmittance[p] = 0.0;
    }
#endif
  }
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

#include "pixels.glsl"
