#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_vote : require
// Stage 6 where subgroups have 32 invocations: one work group a tile, a subgroup a block of it. Each reads the tile's list by
// itself and takes to its own part of shared memory what reaches its block, so that nothing waits at barriers and most of what
// leaves no mark is never blended. The bits are those of blend.comp.
#define STAGE (32 + 2 * AHEAD)  // splats: a round's, those that the last one left, and nothings up to AHEAD
#define BATCH (BLOCKS * STAGE)
#include "blocks.glsl"
#include "blending.glsl"

layout(local_size_x = 32, local_size_y = BLOCKS) in;

void main() {
  if (!find_tile()) return;
  uint lane = gl_SubgroupInvocationID;
  uvec2 in_block = place_in_block(lane);
  begin_pixels(corner_of_block(gl_SubgroupID) + in_block);
  uvec2 first = first_pixel - in_block;
  uvec2 picture = uvec2(views[view_index].width, views[view_index].height);
  if (any(greaterThanEqual(first, picture))) return;

  uint mine = gl_SubgroupID * STAGE;
  uint count = 0u;
  uint next = begin + lane < end ? values[begin + lane] : 0u;
  for (uint at = begin; at < end; at += 32u) {
    Splat splat = SPLAT(next);
    bool kept = at + lane < end && reaches(splat, first, picture);
    next = at + 32u + lane < end ? values[at + 32u + lane] : 0u;
    uint all = subgroupBallot(kept).x;
    if (kept) stage(mine + count + bitCount(all & gl_SubgroupLtMask.x), splat);
    count += bitCount(all);
    bool is_last = at + 32u >= end;
    if (is_last && lane < AHEAD) stage_nothing(mine + count + lane);
    subgroupMemoryBarrierShared();
    subgroupBarrier();
    uint ready = (is_last ? count + AHEAD - 1u : count) / AHEAD * AHEAD;
    for (uint i = 0u; i < ready; i += AHEAD) blend_from(mine + i);
    if (is_last || subgroupAll(are_done())) break;
    subgroupBarrier();
    count -= ready;
    if (lane < count) {
      batch_across[mine + lane] = batch_across[mine + ready + lane];
      batch_down[mine + lane] = batch_down[mine + ready + lane];
      batch_colour[mine + lane] = batch_colour[mine + ready + lane];
    }
    subgroupBarrier();
  }
  write_pixels();
}
