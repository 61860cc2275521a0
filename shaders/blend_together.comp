#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_vote : require
// Stage 6 for tiles of 32 px where subgroups have 32 invocations: one work group a tile. All take the list's next splats to
// shared memory and ask which of the tile's blocks each reaches; then each subgroup blends, by a list of its own, those that
// reach its block. The bits are those of blend.comp.
#define ROUND 128                   // splats at a time: two invocations have each, and half of the blocks
#define WORDS (ROUND / 32)
#define BATCH (ROUND + 1)           // and one that leaves no mark
#include "blocks.glsl"
#include "blending.glsl"

layout(local_size_x = 32, local_size_y = BLOCKS) in;

shared uint reached[BLOCKS][WORDS];        // by block: a bit a splat
shared uint lists[BLOCKS][ROUND + AHEAD];  // by block: its splats of the batch
shared uint blocks_done;

void ask(uint word, uint half_of, uint splat, bool is_one, uvec2 corner, uvec2 picture) {
  uint lane = gl_SubgroupInvocationID;
  if (!subgroupAny(is_one)) {
    if (lane < BLOCKS / 2) reached[half_of * (BLOCKS / 2) + lane][word] = 0u;
    return;
  }
  Splat s = SPLAT(splat);
  if (half_of == 0u && is_one) stage(word * 32u + lane, s);
  for (uint n = 0u; n < BLOCKS / 2; ++n) {
    uint block = half_of * (BLOCKS / 2) + n;
    uint all = subgroupBallot(is_one && reaches(s, corner + corner_of_block(block), picture)).x;
    if (lane == 0u) reached[block][word] = all;
  }
}

void blend_reached() {
  uint block = gl_SubgroupID, lane = gl_SubgroupInvocationID;
  uint count = 0u;
  for (uint word = 0u; word < WORDS; ++word) {
    uint all = reached[block][word];
    if ((all >> lane & 1u) != 0u) lists[block][count + bitCount(all & gl_SubgroupLtMask.x)] = word * 32u + lane;
    count += bitCount(all);
  }
  if (lane < AHEAD) lists[block][count + lane] = ROUND;
  subgroupMemoryBarrierShared();
  subgroupBarrier();
  for (uint i = 0u; i < count; i += AHEAD) {
    uint at[AHEAD];
    for (uint k = 0u; k < AHEAD; ++k) at[k] = lists[block][i + k];
    blend(at);
  }
}

void main() {
  if (!find_tile()) return;
  uvec2 in_tile = corner_of_block(gl_SubgroupID) + place_in_block(gl_SubgroupInvocationID);
  begin_pixels(in_tile);
  uvec2 corner = first_pixel - in_tile;
  uvec2 picture = uvec2(views[view_index].width, views[view_index].height);
  uint self = gl_LocalInvocationIndex;
  if (self == 0u) stage_nothing(ROUND);
  if (self == 0u) blocks_done = 0u;
  bool ended = false;  // of the block
  uint mine = self % ROUND;
  uint next = begin + mine < end ? values[begin + mine] : 0u;
  for (uint at = begin; at < end; at += ROUND) {
    ask(mine / 32u, self / ROUND, next, at + mine < end, corner, picture);
    next = at + ROUND + mine < end ? values[at + ROUND + mine] : 0u;
    barrier();
    if (!ended) {
      blend_reached();
      ended = subgroupAll(are_done());
      if (ended && gl_SubgroupInvocationID == 0u) atomicAdd(blocks_done, 1u);
    }
    barrier();
    if (blocks_done == BLOCKS) break;
  }
  write_pixels();
}
