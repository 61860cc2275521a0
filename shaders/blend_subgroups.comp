#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_vote : require
#if MESH_DEPTH
#extension GL_KHR_shader_subgroup_arithmetic : require
#endif
#if HALF && defined(GL_NV_gpu_shader5)
#extension GL_NV_gpu_shader5 : require
#endif
// Stage 4 on GPUs with subgroups of 32 invocations: one work group per tile, one subgroup per block. The group copies
// the list's next splats to shared memory, and finds the blocks that each splat reaches. Each subgroup blends its
// block's splats. The result equals blend.comp's, bit for bit, except in packed halves (blend_halves.glsl).
#define BLOCK_WIDTH (COLUMN == 8 ? 16 : 8)  // 16: the only block is the whole tile
#define BLOCK_HEIGHT (32 * COLUMN / BLOCK_WIDTH)
#if COLUMN == 8
#define ROUND 32
#elif APPROXIMATE  // blocks of docs/method.md 5.2
#define ROUND APPROXIMATE_STEP
#else
// The number of splats in a round. With larger rounds fewer groups fit in shared memory. The visibility pass has larger
// rounds, because it takes as long as its longest list.
#define ROUND (LISTS == LISTS_SHORT ? 64 : MEASURE == MEASURE_VISIBILITY ? 256 : 128)
#endif
#define BATCH (ROUND + 1)  // the last splat is invisible
#define ANY(condition) subgroupAny(condition)
#define ALL(condition) subgroupAll(condition)
#define MESH_TESTED_BY_BLOCK
#if HALF && defined(GL_NV_gpu_shader5)
#define MAY_PACK 1
#endif
#include "blending.glsl"
#include "reached_blocks.glsl"

layout(local_size_x = 32, local_size_y = BLOCKS) in;

OF_TILE vec2 corner;  // the tile's first pixel

uint value_at(uint at) { return at < end ? values[at] : 0u; }

// The splats of the batch that reach this subgroup's block. keep_blocks() keeps the bits of blocks_of() for a staged
// splat; without a bit it is not listed. list_own() makes the block's list in order, and returns its length. own_at()
// returns a splat of it; AHEAD invisible ones follow. The first `sure` splats are in front of all meshes.
#if COLUMN == 8
#include "blend_whole_tile.glsl"
#else
#include "blend_lists_by_ballots.glsl"
#endif
shared uint blocks_done;  // declared behind the lists: city in half precision x 0.97

#if PACKED
#include "blend_halves.glsl"
#else
// With ENDS_EARLY, the last one or two splats of a list are blended as two: fewer invisible ones than in AHEAD.
#define TAIL (ENDS_EARLY == 1 && AHEAD > 2 ? 2u : 0u)

void blend_own(uint from, const uint count, const bool may_be_hidden) {
  uint at[AHEAD];
  for (uint k = 0u; k < AHEAD; ++k) at[k] = own_at(from + k);
  blend(at, count, may_be_hidden);
}

// Blends the first `own` splats of the block's list.
void blend_batch(uint own) {
  uint i = 0u;
  for (; i + TAIL < own && (ENDS_EARLY == 0 || !block_done) && (MESH_DEPTH == 0 || i + AHEAD <= sure); i += AHEAD)
    blend_own(i, AHEAD, false);
  if (TAIL > 0u && i < own && !block_done) blend_own(i, TAIL, false);
  for (; MESH_DEPTH == 1 && i < own && subgroupAny(!are_done()); i += AHEAD) blend_own(i, AHEAD, true);
}
#endif

void main() {
  if (!find_tile()) return;
  uint self = gl_LocalInvocationIndex;
  uint lane = gl_SubgroupInvocationID;
  uvec2 block = uvec2(gl_SubgroupID % BLOCKS_ACROSS, gl_SubgroupID / BLOCKS_ACROSS);
  uvec2 in_tile = block * uvec2(BLOCK_WIDTH, BLOCK_HEIGHT) + uvec2(lane % BLOCK_WIDTH, lane / BLOCK_WIDTH * COLUMN);
  begin_pixels(in_tile);
  corner = vec2(first_pixel - in_tile);
  if (self == 0u) stage_nothing(ROUND);
  if (self == 0u) blocks_done = 0u;
  bool ended = false;  // the block is done
  uint next = value_at(begin + self);
  uint at_hand = 0u;  // the splat that this invocation copied to the batch, to measure it
#if LISTS == LISTS_LONG  // few groups: they read the next splats early, to hide the latency of memory
  Splat next_splat = SPLAT(next);
  next = value_at(begin + ROUND + self);
#endif
  for (uint batch = begin; batch < end; batch += ROUND) {
    if (self < ROUND) {
      if (MEASURE != MEASURE_NONE) at_hand = value_at(batch + self);
      clear_measured(self);
#if LISTS == LISTS_LONG
      Splat splat = next_splat;
      next_splat = SPLAT(next);
      next = value_at(batch + 2u * ROUND + self);
#else
      Splat splat = SPLAT(next);
      next = value_at(batch + ROUND + self);
#endif
      uint bits = batch + self < end ? blocks_of(splat) : 0u;
      stage(self, splat);
      stage_disc(self, value_at(batch + self), splat.mean);
      keep_blocks(self, bits);
    }
    barrier();
    if (!ended) {
      blend_batch(list_own(COLUMN == 8 ? min(end - batch, uint(ROUND)) : uint(ROUND)));
      ended = subgroupAll(are_dark());
      if (ended && batch + ROUND < end) end_dark();
      if (BLOCKS == 1 && ended) break;
      if (ended && lane == 0u) atomicAdd(blocks_done, 1u);
    }
    if (MEASURE != MEASURE_NONE) {
      barrier();
      if (self < ROUND) pass_on(at_hand, self);
    }
    if (batch + ROUND >= end) break;
    barrier();
    if (BLOCKS > 1 && blocks_done == BLOCKS) break;
  }
  if (MEASURE <= MEASURE_TRANSMITTANCE) write_pixels();  // other measurements write no picture
}
