// Stage 6: the picture. One work group a tile, whose splats pass front to back through shared memory. Tiles with long lists
// are drawn by a launch of their own, which starts first and has more invocations (long_lists.comp).
//
// With SHOW, one of SHOW_ALPHAS to SHOW_LIGHT, it leaves the pictures as they are and tells what it comes by instead.
#define INVOCATIONS (TILE_SIZE * TILE_SIZE / COLUMN)
// Splats in shared memory at a time, 9 KiB at most: with more an H200 holds fewer groups, with less the longest lists take
// longer (src/render/README.md).
#if RECORDS || WEIGHS
#define BATCH_MAX 176
#else
#define BATCH_MAX 192
#endif
#define BATCH (INVOCATIONS < BATCH_MAX ? INVOCATIONS : BATCH_MAX)
#include "blending.glsl"

layout(local_size_x = TILE_SIZE, local_size_y = TILE_SIZE / COLUMN) in;

shared uint alive;  // 1 while a pixel still takes light

#if LIGHT
#define LIGHT_ACROSS (TILE_SIZE / LIGHT_BLOCK)
#define LIGHT_IN_TILE (LIGHT_ACROSS * LIGHT_ACROSS)
shared uint light_depths[LIGHT_IN_TILE][LIGHT_LEVELS];  // bits of floats
uint light_nth[COLUMN];                                 // the first level that the pixel has more than
float light_level[COLUMN];                              // that level

uint light_block(uint p) {
  uvec2 block = (gl_LocalInvocationID.xy * uvec2(1u, COLUMN) + uvec2(0u, p)) / uint(LIGHT_BLOCK);
  return block.y * LIGHT_ACROSS + block.x;
}

void begin_light() {
  for (uint k = gl_LocalInvocationIndex; k < LIGHT_IN_TILE * LIGHT_LEVELS; k += INVOCATIONS)
    light_depths[k / LIGHT_LEVELS][k % LIGHT_LEVELS] = 0u;
  for (uint p = 0u; p < COLUMN; ++p) {
    light_nth[p] = 0u;
    light_level[p] = float(LIGHT_STEP);
  }
  memoryBarrierShared();
  barrier();
}

void follow_light(uint at[AHEAD]) {
  for (uint p = 0u; p < COLUMN; ++p) {
    for (; light_nth[p] < LIGHT_LEVELS && transmittance[p] <= light_level[p]; ++light_nth[p]) {
      atomicMax(light_depths[light_block(p)][light_nth[p]], floatBitsToUint(deepest(at)));
      light_level[p] = next_level(light_level[p], light_nth[p] + 1u);
    }
  }
}

void write_light() {
  View view = views[view_index];
  for (uint p = 0u; p < COLUMN; ++p) {
    bool inside = first_pixel.x < view.width && first_pixel.y + p < view.height;
    for (uint k = light_nth[p]; inside && k < LIGHT_LEVELS; ++k) atomicMax(light_depths[light_block(p)][k], floatBitsToUint(LIGHT_NEVER));
  }
  memoryBarrierShared();
  barrier();
  uvec2 corner = tile_corner(tile_of(tile, view), view) / uint(LIGHT_BLOCK), blocks = light_blocks(view, 0u);
  for (uint k = gl_LocalInvocationIndex; k < LIGHT_IN_TILE * LIGHT_LEVELS / 2u; k += INVOCATIONS) {
    uint in_tile = k / (LIGHT_LEVELS / 2u), pair = k % (LIGHT_LEVELS / 2u);
    uvec2 block = corner + uvec2(in_tile % LIGHT_ACROSS, in_tile / LIGHT_ACROSS);
    if (is_probe(view) || block.x >= blocks.x || block.y >= blocks.y) continue;
    float first = uintBitsToFloat(light_depths[in_tile][2u * pair]), second = uintBitsToFloat(light_depths[in_tile][2u * pair + 1u]);
    light[4u * light_place(view, 0u, block) + pair] = light_word(first / view.anchor.w, second / view.anchor.w);
  }
}
#endif

void load(uint at) {
  uint self = gl_LocalInvocationIndex;
  if (self >= BATCH) return;
#if RECORDS || WEIGHS
  batch_measured[self] = 0u;
#endif
  if (at >= end) {
    stage_nothing(self);
    return;
  }
  stage(self, SPLAT(values[at]));
#if SHOW == SHOW_LIGHT
  batch_light[self] = uintBitsToFloat(measured[values[at]]);
#endif
}

void main() {
  if (!find_tile()) return;
  begin_pixels(gl_LocalInvocationID.xy * uvec2(1u, COLUMN));
#if LIGHT
  begin_light();
#endif
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
    load(batch + gl_LocalInvocationIndex);
    barrier();
    size = min(end - batch, uint(BATCH));
    uint next = 0u;
    for (; next < size && !are_done(); next += BLEND_UNROLL) {
      for (uint i = 0u; i < BLEND_UNROLL; i += AHEAD) blend_from(next + i);
    }
    cut = cut || (!are_done() && next < size);
#if RECORDS || WEIGHS
    barrier();
    uint self = gl_LocalInvocationIndex;
    if (self < size && batch_measured[self] != 0u) pass_on(values[batch + self], batch_measured[self]);
#endif
  }
  if (cut || (!are_done() && batch < end)) atomicAdd(counters.loop_cut, 1u);
  write_pixels();
#if LIGHT
  write_light();
#endif
}
