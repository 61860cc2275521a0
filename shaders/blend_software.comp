// Stage 4 on software renderers such as llvmpipe, which runs eight invocations at once in SIMD lanes. One work group
// per tile, one row of invocations per block of the tile. The group copies the list's next splats to shared memory, and
// finds the blocks that each splat reaches. One invocation per block lists the block's splats, and the block's row
// blends them. The result equals blend.comp's, bit for bit.
#define BLOCK_WIDTH 8
#define BLOCK_HEIGHT COLUMN
#define ROUND (APPROXIMATE == 1 ? APPROXIMATE_STEP : 128)  // splats at a time
#define BATCH (ROUND + 1)  // the last splat is invisible
#include "blending.glsl"
#include "reached_blocks.glsl"

layout(local_size_x = BLOCK_WIDTH, local_size_y = BLOCKS) in;
#define INVOCATIONS (BLOCK_WIDTH * BLOCKS)

shared uint reached[ROUND];                    // by splat of the batch: the blocks that it reaches
shared uint own_lists[BLOCKS][ROUND + BLEND_UNROLL];  // by block: splats of the batch, then invisible ones
shared uint own_counts[BLOCKS];
shared uint bright;  // a bit for each block with a pixel that is not dark

void list_own(uint block) {
  uint bit = bit_of(block), count = 0u, i = 0u;
  for (; i < ROUND; i += BLEND_UNROLL) {
    for (uint k = 0u; k < BLEND_UNROLL; ++k) {
      if ((reached[i + k] >> bit & 1u) == 0u) continue;
      own_lists[block][count] = i + k;
      ++count;
    }
  }
  if (i < ROUND) atomicAdd(counters.truncated_lists, 1u);
  for (uint k = 0u; k < BLEND_UNROLL; ++k) own_lists[block][count + k] = ROUND;
  own_counts[block] = count;
}

void main() {
  if (!find_tile()) return;
  uint self = gl_LocalInvocationIndex, own_block = gl_LocalInvocationID.y;
  uvec2 in_tile = uvec2(own_block % BLOCKS_ACROSS, own_block / BLOCKS_ACROSS) * uvec2(BLOCK_WIDTH, BLOCK_HEIGHT) +
                  uvec2(gl_LocalInvocationID.x, 0u);
  begin_pixels(in_tile);
  vec2 corner = vec2(first_pixel - in_tile);
  if (self == 0u) stage_nothing(ROUND);
  uint batch = begin;
  bool is_truncated = false;
  for (; batch < end; batch += ROUND) {
    if (batch != begin) {
      if (self == 0u) bright = 0u;
      barrier();
      if (!are_dark()) atomicOr(bright, 1u << own_block);
      barrier();
      if ((bright >> own_block & 1u) == 0u) end_dark();
      if (bright == 0u) {
        batch = end;
        break;
      }
    }
    for (uint i = self; i < ROUND; i += INVOCATIONS) {
      uint bits = 0u;
      if (batch + i < end) {
        Splat splat = SPLAT(values[batch + i]);
        bits = blocks_reached(splat, splat.mean - corner);
        stage(i, splat);
        stage_disc(i, values[batch + i], splat.mean);
      }
      reached[i] = bits;
      clear_measured(i);
    }
    barrier();
    if (self < BLOCKS) list_own(self);
    barrier();
    uint count = TAKES_NO_MORE ? 0u : own_counts[own_block], next = 0u;
    for (; next < count && !are_done(); next += BLEND_UNROLL) {
      for (uint i = 0u; i < BLEND_UNROLL; i += AHEAD) {
        uint at[AHEAD];
        for (uint k = 0u; k < AHEAD; ++k) at[k] = own_lists[own_block][next + i + k];
        blend(at);
      }
    }
    is_truncated = is_truncated || (!are_done() && next < count);
    if (MEASURE != MEASURE_NONE) {
      barrier();
      for (uint i = self; i < ROUND; i += INVOCATIONS) {
        if (batch + i < end) pass_on(values[batch + i], i);
      }
    }
  }
  if (is_truncated || batch < end) atomicAdd(counters.truncated_lists, 1u);
  if (MEASURE <= MEASURE_TRANSMITTANCE) write_pixels();  // other measurements write no picture
}
