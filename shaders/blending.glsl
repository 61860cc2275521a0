// Shared by the programs of stage 4: an invocation's pixels, and how splats are blended into them (docs/method.md 3).
//   COLUMN      pixels of an invocation, one below the other
//   AHEAD       splats whose alphas are computed at once
//   BATCH       splats that the work group has in shared memory; the including file fills them by stage()
//   LISTS       LISTS_LONG: only tiles of more than LONG_LIST pairs; LISTS_SHORT: only the others
//   APPROXIMATE 1: the blend of docs/method.md 5.2 (blend_dark_blocks.glsl)
//   DEPTH       the depth in z_sums, DEPTH_ of shared/limits.h (blend_depth.glsl)
//   CANVASES    1: pictures of views go into images, and z_sums are depths (blend_pictures.glsl)
//   MEASURE     the value measured of each splat, MEASURE_ of shared/limits.h; its file is measure/NAME.glsl
//   DEBUG_VIEW  1: writes a value for each pixel instead of the picture (blend_debug.glsl)
//   PLAIN       1: views are drawn completely, there is no probe, and colours are display values, also those that an
//               image's alpha multiplies: with fewer branches a GPU blends 5 % faster
//   MESH_DEPTH  1: splats behind the caller's meshes are not drawn (blend_mesh.glsl)
//   DISCS       1: depths of flat Gaussians are on their planes (blend_depth.glsl)
//   ENDS_EARLY  1: a block may end within a round (block_done)
//   ANY, ALL    whether a condition holds in any, or in all, invocations of the subgroup; by default, in this invocation
//   REACHES     whether a splat of the batch reaches this invocation's block; by default all do
#include "list_lengths.glsl"
#include "shared/grid.glsl"
#include "frame.glsl"
#if !PLAIN
#define PROBED 1
#define REGIONS 1
#endif
#include "projection.glsl"
#include "supertiles.glsl"
#include "tiles/places.glsl"
#include "splats.glsl"  // binding 12

#ifndef ANY
#define ANY(condition) (condition)
#define ALL(condition) (condition)
#endif

// Whether pixels are blended in packed halves (blend_halves.glsl). Only the variants that most frames use do so.
#ifndef MAY_PACK
#define MAY_PACK 0
#endif
#define PACKED (MAY_PACK && COLUMN > 1 && PROJECTION == PROJECTION_AFFINE && DEPTH <= DEPTH_MEAN && MEASURE == MEASURE_NONE && !MESH_DEPTH)

// With the tangent projection, a wide splat may be in front of some rays of a broad tile and behind others.
#ifndef IS_BROAD
#define IS_BROAD false
#endif

#ifndef REACHES
#define REACHES(at) true
#endif

layout(std430, binding = 0) readonly buffer Views { View views[]; };
layout(std430, binding = 1) readonly buffer Ranges { uint ranges[]; };
layout(std430, binding = 2) readonly buffer Values { uint values[]; };
layout(std430, binding = 6) buffer FrameCounters { Counters counters; };
#if LISTS == LISTS_LONG
layout(std430, binding = 9) readonly buffer LongLists { uint long_lists[]; };  // tiles
#endif

// -log2(alpha) in pixel (x, y) of the cell is (t^2 + s) + y ((2 b t + v) + c y), with t = a x + u (see stage()). With
// the tangent projection s lacks -log2(sigma), which is added after the division by |d|^2, with d the pixel's ray.
shared vec4 batch_across[BATCH];  // a, u, 2 b, s
shared vec4 batch_down[BATCH];    // v, c; tangent projection: -log2(sigma), direction_in_bytes()
#if PACKED  // the last two of batch_down are rg and b as halves
shared float batch_depth[BATCH];
float depth_of(uint at) { return batch_depth[at]; }
void stage_colour(uint at, vec3 colour, float depth) { batch_depth[at] = depth; }
vec2 packed_colour(Splat splat) {
  return uintBitsToFloat(uvec2(packHalf2x16(splat.colour.rg), packHalf2x16(vec2(splat.colour.b, 0.0))));
}
#else
shared vec4 batch_colour[BATCH];  // rgb, depth
float depth_of(uint at) { return batch_colour[at].a; }
void stage_colour(uint at, vec3 colour, float depth) { batch_colour[at] = vec4(colour, depth); }
vec2 packed_colour(Splat splat) { return vec2(0.0); }
#endif

uint view_index = 0u;
uvec2 first_pixel;  // the upper pixel of this invocation
float column;       // x from the middle of the cell
float row[COLUMN];  // by pixel: y from the middle of the cell
uint size;          // splats in the batch
vec3 colour[COLUMN];
float z_sum[COLUMN];
float weights[COLUMN][AHEAD];  // of the splats at hand: first their alphas, then their weights
float transmittance[COLUMN];  // 0 once the pixel is done
float least[COLUMN];          // -T once the pixel is done; before that, the T at which the blend stops
bool block_done = false;      // with ENDS_EARLY, all pixels of the subgroup are done

bool is_done(uint p) { return least[p] < 0.0; }

bool are_done() {
  bool all = true;
  for (uint p = 0u; p < COLUMN; ++p) all = all && is_done(p);
  return all;
}

float transmittance_left(uint p) { return is_done(p) ? -least[p] : transmittance[p]; }

// Ends a pixel before its next splat.
void end_pixel(uint p) {
  if (!is_done(p)) {
    least[p] = -transmittance[p];
    transmittance[p] = 0.0;
  }
}

#include "blend_pictures.glsl"
// What the blend measures of each splat, over the pixels that the splat reaches. A tile accumulates the value in shared
// memory, and updates the buffer once per splat, to save time. Sums are integers, so their order does not matter.
//   MARK(p, k, alpha)                                     notes an alpha of one of the AHEAD splats at hand
//   measure(at, p, k, weight), end_measuring_splat(at)    add each pixel to a splat's value, then end the splat
//   pass_on(splat, at)                                    updates the buffer by the tile's value
#include "measure/{MEASURE_NAME}.glsl"

// What depends on the projection:
//   begin_rays(view, corner)                 begins the tile whose first pixel is `corner`
//   exponent_in(p, exponent, down)           -log2(alpha) in pixel p, of the polynomial in batch_across
//   drop_behind_eye(at)                      clears alphas of rays that point away from a splat
//   view_z_of(p, depth), from_view_z(p, z)   convert between a splat's depth and view z, along a pixel's ray
//   staged_rest(splat, v, bits)              s of batch_across, then what batch_down has besides v and c
// OF_TILE: where values of the tile are stored.
#include "blend_{PROJECTION_NAME}.glsl"
OF_TILE vec2 middle;  // middle of the tile's cell (BLEND_CELL), px

#if MESH_DEPTH
#include "blend_mesh.glsl"
#else
#define MESH(p) 0.0
void begin_meshes(uint p, bool inside) {}
float mesh_behind(uint p) { return 0.0; }
void end_behind_mesh(uint at, uint p, float farthest) {}
#endif
#include "blend_depth.glsl"
#include "blend_debug.glsl"
#if APPROXIMATE
#include "blend_dark_blocks.glsl"
#else
#define are_dark are_done
#define TAKES_NO_MORE false
void begin_block(View view) {}
void end_dark() {}
float finished(uint p) { return transmittance_left(p); }
#endif

#if !PACKED
// Some outputs need the transmittance before each splat.
#define FOLLOWS_TRANSMITTANCE (MEASURE != MEASURE_NONE || DEPTH == DEPTH_VISIBILITY || DEBUG_VIEW != 0)

// Sets `weights` to the alphas of the first `count` of AHEAD splats of the batch. With `may_be_hidden`, also compares
// depths with each pixel's mesh.
void set_alphas(uint at[AHEAD], const uint count, const bool may_be_hidden) {
  float hidden_from[COLUMN];
  if (may_be_hidden) {
    for (uint p = 0u; p < COLUMN; ++p) {
      hidden_from[p] = MESH(p);
      end_behind_mesh(at[0], p, hidden_from[p]);
    }
  }
  for (uint k = 0u; k < count; ++k) {
    vec4 across = batch_across[at[k]];
    vec4 down = batch_down[at[k]];
    precise float t = fma(across.x, column, across.y);
    precise float level = fma(t, t, across.w);
    precise float slope = fma(t, across.z, down.x);
    for (uint p = 0u; p < COLUMN; ++p) {
      precise float exponent = exponent_in(p, fma(row[p], fma(row[p], down.y, slope), level), down);
      precise float a = exp2(-exponent);
      bool is_seen = a >= float(ALPHA_MIN) && REACHES(at[k]);  // NaN: false
      if (may_be_hidden) is_seen = is_seen && depth_of(at[k]) <= hidden_from[p];
      weights[p][k] = is_seen ? min(float(ALPHA_MAX), a) : 0.0;
      MARK(p, k, a);
    }
  }
  drop_behind_eye(at);
}

// Ends a pixel before the first splat at hand that would lower T below `least`. Later splats get no weight.
void stop(uint p, const uint count) {
  precise float next = transmittance[p];
  float last = next;
  for (uint k = 0u; k < count; ++k) {
    next -= weights[p][k];
    bool is_kept = next >= least[p];
    weights[p][k] = is_kept ? weights[p][k] : 0.0;
    last = is_kept ? next : last;
  }
  least[p] = -last;
}

// Adds the splats at hand to the pixels.
void add(uint at[AHEAD], const uint count) {
  for (uint k = 0u; k < count; ++k) {
    vec4 c = batch_colour[at[k]];
    for (uint p = 0u; p < COLUMN; ++p) {
      float weight = weights[p][k];
      measure(at[k], p, k, weight);
      precise float r = fma(weight, c.r, colour[p].r);
      precise float g = fma(weight, c.g, colour[p].g);
      precise float b = fma(weight, c.b, colour[p].b);
      add_depth(p, weight, depth_in(p, at[k], c.a));
      if (FOLLOWS_TRANSMITTANCE) transmittance[p] -= weight;
      debug_blended(at[k], weight);
      colour[p] = vec3(r, g, b);
    }
    end_measuring_splat(at[k]);
  }
}

// Blends the first `count` of AHEAD splats of the batch at once: their alphas are independent, only T is sequential.
void blend(uint at[AHEAD], const uint count, const bool may_be_hidden) {
  set_alphas(at, count, may_be_hidden);
  float left[COLUMN];
  bool some_stop = false;  // one test for all pixels: a branch for each takes 2 % of the time
  for (uint p = 0u; p < COLUMN; ++p) {
    debug_evaluated(at[0]);
    precise float next = transmittance[p];
    for (uint k = 0u; k < count; ++k) {
      precise float weight = weights[p][k] * next;
      weights[p][k] = weight;
      next -= weight;
    }
    left[p] = next;
    some_stop = some_stop || next < least[p];
  }
  // Rare: a pixel stops before one of these splats. If the whole subgroup takes this branch, it can vote there, which
  // costs nothing where no pixel stops.
  if (ENDS_EARLY == 1 ? ANY(some_stop) : some_stop) {
    for (uint p = 0u; p < COLUMN; ++p) {
      if (left[p] >= least[p]) continue;
      stop(p, count);
      left[p] = 0.0;
    }
    if (ENDS_EARLY == 1) block_done = ALL(are_done());
  }
  for (uint p = 0u; p < COLUMN; ++p) {
    bool is_half = transmittance[p] >= half_left && left[p] < half_left;
    if (HAS_MEDIAN(p) && ANY(is_half)) {  // rare
      float depth = median_depth(p, at, weights[p], transmittance[p]);
      if (is_half) z_sum[p] = depth;
    }
  }
  add(at, count);
  for (uint p = 0u; p < COLUMN; ++p) {
    transmittance[p] = left[p];
    if (MEASURE == MEASURE_VISIBILITY && left[p] < float(VISIBILITY_MIN)) end_pixel(p);
  }
}

void blend(uint at[AHEAD]) { blend(at, AHEAD, MESH_DEPTH != 0); }

#endif

// Writes a splat into the batch; stage_nothing() writes an invisible one. alpha = sigma 2^-|L^T d|^2, with d = pixel -
// mean and L the lower Cholesky factor of Q log2(e) / 2. The exponent is stored as a polynomial in the pixel's position
// relative to the middle of its cell. Splats are at least as wide as the low-pass, and visible up to a few of their
// widths from the mean. So no term is large in visible pixels, and the sum is exact to 1e-4. Cells, and so the sum, do
// not depend on a window's corner.
void stage(uint at, Splat splat) {
  const float scale = 0.72134752044448170;  // log2(e) / 2
  stage_colour(at, splat.colour.rgb, abs(splat.depth));
  precise vec2 mean = splat.mean - middle;
  precise float xx = sqrt(scale * splat.conic.x);
  precise float yx = scale * splat.conic.y / xx;
  precise float yy = scale / (abs(splat.conic.w) * xx);
  precise float u = -fma(xx, mean.x, yx * mean.y);
  precise float v = -yy * mean.y;
  precise float bits = splat.opacity >= float(ALPHA_MIN) ? log2(splat.opacity) : -1e30;
  precise float slope = 2.0 * v * yy;
  precise float bend = fma(yx, yx, yy * yy);
  vec3 rest = staged_rest(splat, v, bits);
  batch_across[at] = vec4(xx, u, 2.0 * yx, rest.x);
  batch_down[at] = vec4(slope, bend, rest.yz);
}

void stage_nothing(uint at) {
  stage_no_disc(at);
  stage_colour(at, vec3(0.0), 0.0);
  batch_across[at] = vec4(0.0, 0.0, 0.0, 1e30);
  batch_down[at] = vec4(0.0);
}

#include "pixels.glsl"
