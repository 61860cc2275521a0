// Stage 4: blends the pictures. One work group per tile. The tile's splats pass through shared memory in batches, front
// to back. Debug views, and all measurements except visibility, use only this program.
#include "lists.glsl"
#define INVOCATIONS (TILE_SIZE * TILE_SIZE / COLUMN)
// The largest number of splats in a batch, of up to 9 KiB. With larger batches an H200 runs fewer work groups at a
// time; with smaller ones the longest lists take longer (src/render/README.md).
#if APPROXIMATE
#define BATCH_MAX APPROXIMATE_STEP
#elif MEASURE
#define BATCH_MAX 176
#else
#define BATCH_MAX 192
#endif
#define BATCH (INVOCATIONS < BATCH_MAX ? INVOCATIONS : BATCH_MAX)
#if !PLAIN
#define IS_BROAD (frame.has_broad_tiles != 0u)
#endif
#if APPROXIMATE
#define REACHES(at) ((reached[at] >> own_bit & 1u) != 0u)
shared uint reached[BATCH];  // by splat of the batch: the blocks that it reaches
uint own_bit, dark_bit;
#define BLOCK_WIDTH APPROXIMATE_BLOCK
#define BLOCK_HEIGHT APPROXIMATE_BLOCK
#endif
#include "blending.glsl"
#if APPROXIMATE
#include "blocks.glsl"
vec2 corner;  // the tile's first pixel
#endif

layout(local_size_x = TILE_SIZE, local_size_y = TILE_SIZE / COLUMN) in;

// A dispatch blends `part_size` splats of each list, after `before_part` splats that other dispatches blended.
#define IN_PARTS (LISTS == LISTS_LONG && !APPROXIMATE && !DEBUG_VIEW)
#if IN_PARTS
uniform uint before_part;
uniform uint part_size;
layout(std430, binding = 8) buffer Unfinished { vec4 unfinished[]; };  // by pixel, until the last part: C, T; Z, is done

void keep_pixels() {
  for (uint p = 0u; p < COLUMN; ++p) {
    if (!is_inside(views[view_index], p)) continue;
    uint at = 2u * place_of(views[view_index], p);
    unfinished[at] = vec4(colour[p], transmittance_left(p));
    unfinished[at + 1u] = vec4(z_sum[p], is_done(p) ? 1.0 : 0.0, 0.0, 0.0);
  }
}

void take_pixels() {
  for (uint p = 0u; p < COLUMN; ++p) {
    if (!is_inside(views[view_index], p)) continue;
    uint at = 2u * place_of(views[view_index], p);
    colour[p] = unfinished[at].rgb;
    transmittance[p] = unfinished[at].a;
    z_sum[p] = unfinished[at + 1u].x;
    if (unfinished[at + 1u].y == 0.0) continue;
    least[p] = -transmittance[p];
    transmittance[p] = 0.0;
  }
}
#endif

shared uint lit;  // 1 if a pixel is not done
#if APPROXIMATE
shared uint bright;  // a bit for each block that is not dark
#endif

void load(uint at) {
  uint self = gl_LocalInvocationIndex;
  if (self >= BATCH) return;
  clear_measured(self);
  if (at >= end) {
    stage_nothing(self);
    return;
  }
  Splat splat = SPLAT(values[at]);
#if APPROXIMATE
  reached[self] = blocks_reached(splat, splat.mean - corner);
#endif
  stage(self, splat);
  stage_disc(self, values[at], splat.mean);
  debug_stage(self, values[at]);
}

void main() {
  if (!find_tile()) return;
  uvec2 in_tile = gl_LocalInvocationID.xy * uvec2(1u, COLUMN);
  begin_pixels(in_tile);
  bool is_first = true, is_last = true;
#if IN_PARTS
  is_first = before_part == 0u;
  if (!is_first && before_part >= end - begin) return;  // another part was the last
  begin += before_part;
  is_last = end - begin <= part_size;
  if (!is_last) end = begin + part_size;
  if (!is_first) take_pixels();
#endif
#if APPROXIMATE
  uvec2 block = in_tile / APPROXIMATE_BLOCK;
  own_bit = bit_of(block.y * BLOCKS_ACROSS + block.x);
  dark_bit = 1u << in_tile.y / APPROXIMATE_ROWS * BLOCKS_ACROSS + block.x;
  corner = vec2(first_pixel - in_tile);
#endif
  uint batch = begin;
  bool is_truncated = false;
  for (; batch < end; batch += BATCH) {
    if (batch != begin || !is_first) {
      if (gl_LocalInvocationIndex == 0u) {
        lit = 0u;
#if APPROXIMATE
        bright = 0u;
#endif
      }
      barrier();
      if (!are_done()) lit = 1u;
#if APPROXIMATE
      if (!are_dark()) atomicOr(bright, dark_bit);
#endif
      barrier();
      if (lit == 0u) break;
#if APPROXIMATE
      bool is_test_step = (batch - begin) % APPROXIMATE_STEP == 0u;
      if (is_test_step && (bright & dark_bit) == 0u) end_dark();
      // Measurements of transmittance also need the splats behind dark blocks.
      if (MEASURE != MEASURE_TRANSMITTANCE && is_test_step && bright == 0u) break;
#endif
    }
    load(batch + gl_LocalInvocationIndex);
    barrier();
    size = min(end - batch, uint(BATCH));
    uint next = 0u;
    for (; next < size && !are_done() && !TAKES_NO_MORE; next += BLEND_UNROLL) {
      for (uint i = 0u; i < BLEND_UNROLL; i += AHEAD) blend_from(next + i);
    }
    is_truncated = is_truncated || (!are_done() && !TAKES_NO_MORE && next < size);
    if (MEASURE != MEASURE_NONE) {
      barrier();
      uint self = gl_LocalInvocationIndex;
      if (self < size) pass_on(values[batch + self], self);
    }
  }
  if (is_truncated || (!are_done() && !TAKES_NO_MORE && batch < end)) atomicAdd(counters.truncated_lists, 1u);
#if IN_PARTS
  if (!is_last) {
    keep_pixels();
    return;
  }
#endif
  if (MEASURE <= MEASURE_TRANSMITTANCE) write_pixels();  // other measurements write no picture
}
