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
#define BLOCK_WIDTH 8
#define BLOCK_HEIGHT (4 * COLUMN)
#if APPROXIMATE  // blocks of docs/method.md 5.2
#define ROUND APPROXIMATE_STEP
#else
// The number of splats in a round. With larger rounds fewer groups fit in shared memory. The visibility pass has larger
// rounds, because it takes as long as its longest list.
#define ROUND (LISTS == LISTS_SHORT ? 64 : MEASURE == MEASURE_VISIBILITY ? 256 : 128)
#endif
#define WORDS (ROUND / 32)
#define BATCH (ROUND + 1)  // the last splat is invisible
#define ANY(condition) subgroupAny(condition)
#define MESH_TESTED_BY_BLOCK
#if HALF && defined(GL_NV_gpu_shader5)
#define MAY_PACK 1
#endif
#include "blending.glsl"
#include "blocks.glsl"

layout(local_size_x = 32, local_size_y = BLOCKS) in;

shared uint reached[ROUND];                    // by splat of the batch: the blocks that it reaches
shared uint own_lists[BLOCKS][ROUND + AHEAD];  // by block: the splats of the batch that reach it
shared uint blocks_done;
OF_TILE vec2 corner;                           // the tile's first pixel

uint value_at(uint at) { return at < end ? values[at] : 0u; }

uint sure;  // this many splats, from the begin of the block's list on, are in front of all meshes

// Updates `sure` by 32 splats of the batch; `all` are those that reach the block, behind `count` others.
#if MESH_DEPTH
void find_hidden(uint at, bool reaches, uint all, uint count) {
  if (nearest_mesh < NO_MESH) {
    uint hidden = subgroupBallot(reaches && depth_of(at) > nearest_mesh).x;
    if (hidden != 0u) sure = min(sure, count + bitCount(all & (hidden & -hidden) - 1u));
  }
}
#else
void find_hidden(uint at, bool reaches, uint all, uint count) {}
#endif

// Lists the batch's splats that reach this subgroup's block, in order, then AHEAD invisible ones. Returns the number of
// splats that reach the block.
uint list_own() {
  uint lane = gl_SubgroupInvocationID, bit = bit_of(gl_SubgroupID);
  uint count = 0u;
  sure = ROUND + AHEAD;
  uint mine[WORDS];  // all reads are issued before the first is used
  for (uint word = 0u; word < WORDS; ++word) mine[word] = reached[word * 32u + lane];
  for (uint word = 0u; word < WORDS; ++word) {
    bool reaches = (mine[word] >> bit & 1u) != 0u;
    uint all = subgroupBallot(reaches).x;
    if (reaches) own_lists[gl_SubgroupID][count + bitCount(all & gl_SubgroupLtMask.x)] = word * 32u + lane;
    find_hidden(word * 32u + lane, reaches, all, count);
    count += bitCount(all);
  }
  if (lane < AHEAD) own_lists[gl_SubgroupID][count + lane] = ROUND;
  subgroupMemoryBarrierShared();  // subgroupBarrier() also waits for global memory: 2 % of the time
  return count;
}

#if PACKED
uint own_at(uint i) { return own_lists[gl_SubgroupID][i]; }
#include "blend_halves.glsl"
#else
void blend_own(uint from, const bool may_be_hidden) {
  uint at[AHEAD];
  for (uint k = 0u; k < AHEAD; ++k) at[k] = own_lists[gl_SubgroupID][from + k];
  blend(at, may_be_hidden);
}

// Blends the first `own` splats of the block's list.
void blend_batch(uint own) {
  uint i = 0u;
  for (; i < own && (MESH_DEPTH == 0 || i + AHEAD <= sure); i += AHEAD) blend_own(i, false);
  for (; MESH_DEPTH == 1 && i < own && subgroupAny(!are_done()); i += AHEAD) blend_own(i, true);
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
      uint bits = batch + self < end ? blocks_reached(splat, splat.mean - corner) : 0u;
      stage(self, splat);
      stage_disc(self, value_at(batch + self), splat.mean);
      reached[self] = bits;
    }
    barrier();
    if (!ended) {
      blend_batch(list_own());
      ended = subgroupAll(are_dark());
      if (ended && batch + ROUND < end) end_dark();
      if (ended && lane == 0u) atomicAdd(blocks_done, 1u);
    }
    if (MEASURE != MEASURE_NONE) {
      barrier();
      if (self < ROUND) pass_on(at_hand, self);
    }
    if (batch + ROUND >= end) break;
    barrier();
    if (blocks_done == BLOCKS) break;
  }
  if (MEASURE <= MEASURE_TRANSMITTANCE) write_pixels();  // other measurements write no picture
}
