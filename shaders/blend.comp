// Stage 4: blends the pictures. One work group per tile. The tile's splats pass through shared memory in batches, front
// to back. Debug views, and all measurements except visibility, use only this program.
#include "list_lengths.glsl"
#include "shared/choices.h"
// In short lists of exact pictures, each block of the tile has a list of its splats (blend_lists_by_masks.glsl).
#define LISTED (COLUMN == 2 && !APPROXIMATE && !MEASURE && !MESH_DEPTH && (PLAIN || PROJECTION == PROJECTION_AFFINE))
#define INVOCATIONS (TILE_SIZE * TILE_SIZE / COLUMN)
// The largest number of splats in a batch, of up to 9 KiB. With larger batches an H200 runs fewer work groups at a
// time; with smaller ones the longest lists take longer (src/render/README.md).
#if APPROXIMATE
#define BATCH_MAX APPROXIMATE_STEP
#elif LISTED
#define BATCH_MAX 64
#elif MEASURE
#define BATCH_MAX 176
#else
#define BATCH_MAX 192
#endif
#define ROUND (INVOCATIONS < BATCH_MAX ? INVOCATIONS : BATCH_MAX)
#if LISTED
#define BATCH (ROUND + 1)  // the last splat is invisible
#define STEP AHEAD         // splats in one round of the loop
#else
#define BATCH ROUND
#define STEP BLEND_UNROLL
#endif
#if !PLAIN
#define IS_BROAD (frame.has_broad_tiles != 0u)
#endif
#if APPROXIMATE
#define REACHES(at) ((reached[at] >> own_bit & 1u) != 0u)
shared uint reached[BATCH];  // by splat of the batch: the blocks that it reaches
uint own_bit;
#endif
#define BLOCK_WIDTH APPROXIMATE_BLOCK
#define BLOCK_HEIGHT APPROXIMATE_BLOCK
#include "blending.glsl"
#include "reached_blocks.glsl"

layout(local_size_x = TILE_SIZE, local_size_y = TILE_SIZE / COLUMN) in;

shared uint lit;  // 1 if a pixel is not done
vec2 corner;      // the tile's first pixel
#if !LISTED && !APPROXIMATE
void begin_own_block(uvec2 in_tile) {}
void find_blocks(uint at, Splat splat) {}
#endif
#if LISTED
#include "blend_lists_by_masks.glsl"
#else
uvec2 place_in_tile() { return gl_LocalInvocationID.xy * uvec2(1u, COLUMN); }
uint list_own(uint in_batch) { return in_batch; }
uint own_at(uint i) { return i; }
#endif
#if APPROXIMATE
#include "blend_dark_together.glsl"
#else
void clear_bright() {}
void mark_bright() {}
bool ends_dark(uint blended) { return false; }
#endif
#if LISTS == LISTS_LONG && !APPROXIMATE && !DEBUG_VIEW
#include "blend_parts.glsl"
#else
const bool is_first = true, is_last = true;
bool begin_part() { return true; }
void keep_pixels() {}
#endif

void load(uint at) {
  uint self = gl_LocalInvocationIndex;
  if (self >= ROUND) return;
  clear_measured(self);
  if (at >= end) {
    stage_nothing(self);
    return;
  }
  Splat splat = SPLAT(values[at]);
  find_blocks(self, splat);
  stage(self, splat);
  stage_disc(self, values[at], splat.mean);
  debug_stage(self, values[at]);
}

void main() {
  if (!find_tile()) return;
  uvec2 in_tile = place_in_tile();
  begin_pixels(in_tile);
  corner = vec2(first_pixel - in_tile);
  if (!begin_part()) return;
  begin_own_block(in_tile);
  uint batch = begin;
  bool is_truncated = false;
  for (; batch < end; batch += ROUND) {
    if (batch != begin || !is_first) {
      if (gl_LocalInvocationIndex == 0u) {
        lit = 0u;
        clear_bright();
      }
      barrier();
      if (!are_done()) lit = 1u;
      mark_bright();
      barrier();
      if (lit == 0u || ends_dark(batch - begin)) break;
    }
    load(batch + gl_LocalInvocationIndex);
    barrier();
    size = list_own(min(end - batch, uint(ROUND)));
    uint next = 0u;
    for (; next < size && !are_done() && !TAKES_NO_MORE; next += STEP) {
      for (uint i = 0u; i < STEP; i += AHEAD) {
        uint at[AHEAD];
        for (uint k = 0u; k < AHEAD; ++k) at[k] = own_at(next + i + k);
        blend(at);
      }
    }
    is_truncated = is_truncated || (!are_done() && !TAKES_NO_MORE && next < size);
    if (MEASURE != MEASURE_NONE) {
      barrier();
      uint self = gl_LocalInvocationIndex;
      if (self < size) pass_on(values[batch + self], self);
    }
  }
  if (is_truncated || (!are_done() && !TAKES_NO_MORE && batch < end)) atomicAdd(counters.truncated_lists, 1u);
  if (!is_last) keep_pixels();
  else if (MEASURE <= MEASURE_TRANSMITTANCE) write_pixels();  // other measurements write no picture
}
