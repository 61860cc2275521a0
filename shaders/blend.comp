// Stage 6: the picture. One work group a tile, whose splats pass front to back through shared memory. Tiles with long lists
// are drawn by a launch of their own, which starts first and has more invocations (blend_long_lists.comp).
//
// With SHOW, one of SHOW_ALPHAS to SHOW_LIGHT, it leaves the pictures as they are and tells what it comes by instead.
#include "lists.glsl"
#define INVOCATIONS (TILE_SIZE * TILE_SIZE / COLUMN)
// Splats in shared memory at a time, 9 KiB at most: with more an H200 holds fewer groups, with less the longest lists take
// longer (src/render/README.md).
#if LOSSY
#define BATCH_MAX LOSSY_STEP
#elif RECORDS || SUMS != SUMS_NONE
#define BATCH_MAX 176
#else
#define BATCH_MAX 192
#endif
#define BATCH (INVOCATIONS < BATCH_MAX ? INVOCATIONS : BATCH_MAX)
#if LOSSY
#define REACHES(at) ((reached[at] >> own_bit & 1u) != 0u)
shared uint reached[BATCH];  // the blocks of each of the batch
uint own_bit, dark_bit;
#define BLOCK_WIDTH LOSSY_BLOCK
#define BLOCK_HEIGHT LOSSY_BLOCK
#endif
#include "blending.glsl"
#if LOSSY
#include "blocks.glsl"
vec2 corner;  // the tile's first pixel
#endif

layout(local_size_x = TILE_SIZE, local_size_y = TILE_SIZE / COLUMN) in;

shared uint lit;  // 1 while a pixel still takes light
#if LOSSY
shared uint bright;  // a bit a block that is not dark
#endif

void load(uint at) {
  uint self = gl_LocalInvocationIndex;
  if (self >= BATCH) return;
#if RECORDS || SUMS != SUMS_NONE
  batch_measured[self] = MEASURED(0);
#endif
  if (at >= end) {
    stage_nothing(self);
    return;
  }
  Splat splat = SPLAT(values[at]);
#if PROJECTION == PROJECTION_TANGENT
  // Lists of tiles hold what lies ahead of their rays only: it has faded long before it comes to lie behind.
  if (frame.list_per_view != 0u && is_wide(splat)) {
    float facing = 1.0 + dot(slope_at(views[view_index], splat.mean), slope_at(views[view_index], middle));
    if (facing > 0.0 == splat.conic.w < 0.0) splat.opacity = 0.0;
  }
#endif
#if LOSSY
  reached[self] = blocks_reached(splat, splat.mean - corner);
#endif
  stage(self, splat);
#if SHOW == SHOW_LIGHT
  batch_light[self] = uintBitsToFloat(measured[values[at]]);
#endif
}

void main() {
  if (!find_tile()) return;
  uvec2 in_tile = gl_LocalInvocationID.xy * uvec2(1u, COLUMN);
  begin_pixels(in_tile);
#if LOSSY
  uvec2 block = in_tile / LOSSY_BLOCK;
  own_bit = bit_of(block.y * BLOCKS_ACROSS + block.x);
  dark_bit = 1u << in_tile.y / LOSSY_ROWS * BLOCKS_ACROSS + block.x;
  corner = vec2(first_pixel - in_tile);
#endif
  uint batch = begin;
  bool cut = false;
  for (; batch < end; batch += BATCH) {
    if (batch != begin) {
      if (gl_LocalInvocationIndex == 0u) {
        lit = 0u;
#if LOSSY
        bright = 0u;
#endif
      }
      barrier();
      if (!are_done()) lit = 1u;
#if LOSSY
      if (!are_dark()) atomicOr(bright, dark_bit);
#endif
      barrier();
      if (lit == 0u) break;
#if LOSSY
      bool is_asked = (batch - begin) % LOSSY_STEP == 0u;
      if (is_asked && (bright & dark_bit) == 0u) end_dark();
      if (RECORDS == 0 && is_asked && bright == 0u) break;  // what measures asks what is behind, too
#endif
    }
    load(batch + gl_LocalInvocationIndex);
    barrier();
    size = min(end - batch, uint(BATCH));
    uint next = 0u;
    for (; next < size && !are_done() && !TAKES_NO_MORE; next += BLEND_UNROLL) {
      for (uint i = 0u; i < BLEND_UNROLL; i += AHEAD) blend_from(next + i);
    }
    cut = cut || (!are_done() && !TAKES_NO_MORE && next < size);
#if RECORDS || SUMS != SUMS_NONE
    barrier();
    uint self = gl_LocalInvocationIndex;
    if (self < size) pass_on(values[batch + self], batch_measured[self]);
#endif
  }
  if (cut || (!are_done() && !TAKES_NO_MORE && batch < end)) atomicAdd(counters.loop_cut, 1u);
#if SUMS == SUMS_NONE  // the picture stays
  write_pixels();
#endif
}
