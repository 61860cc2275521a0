#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_vote : require
// Stage 6 where subgroups have 32 invocations: one work group a tile, a subgroup a block of it. Each reads the tile's list by
// itself and takes to its own part of shared memory what reaches its block, so that nothing waits at barriers and most of what
// leaves no mark is never blended. The bits are those of blend.comp.
#define BLOCK_WIDTH (COLUMN == 4 ? 16 : 8)
#define BLOCK_HEIGHT (32 / BLOCK_WIDTH * COLUMN)
#define BLOCKS ((TILE_SIZE / BLOCK_WIDTH) * (TILE_SIZE / BLOCK_HEIGHT))
#define STAGE (32 + 2 * AHEAD)  // splats: a round's, those that the last one left, and nothings up to AHEAD
#define SUBGROUPS (BLOCKS < 8 ? BLOCKS : 8)  // of a group; with larger tiles each draws one block after the other
#define BATCH (SUBGROUPS * STAGE)
#include "blending.glsl"
#include "tiles/level.glsl"

layout(local_size_x = 32, local_size_y = SUBGROUPS) in;

// Whether alpha comes to ALPHA_MIN in any pixel of the block; that it does not is certain.
bool reaches(Splat splat, vec2 low, vec2 high) {
  vec2 at;
  return lowest_level(splat, low, high, at) <= 2.0 * log(splat.opacity / float(ALPHA_MIN)) + 1e-4;
}

void draw(uint nth) {
  uint lane = gl_SubgroupInvocationID;
  uvec2 block = uvec2(nth % (TILE_SIZE / BLOCK_WIDTH), nth / (TILE_SIZE / BLOCK_WIDTH)) * uvec2(BLOCK_WIDTH, BLOCK_HEIGHT);
  uvec2 in_block = uvec2(lane % BLOCK_WIDTH, lane / BLOCK_WIDTH * COLUMN);
  begin_pixels(block + in_block);
  uvec2 first = first_pixel - in_block;
  uvec2 picture = uvec2(views[view_index].width, views[view_index].height);
  if (any(greaterThanEqual(first, picture))) return;
  vec2 low = vec2(first);
  vec2 high = vec2(min(first + uvec2(BLOCK_WIDTH, BLOCK_HEIGHT), picture) - 1u);

  uint mine = gl_SubgroupID * STAGE;
  uint count = 0u;
  uint next = begin + lane < end ? values[begin + lane] : 0u;
  for (uint at = begin; at < end; at += 32u) {
    Splat splat = splats[next];
    bool kept = at + lane < end && reaches(splat, low, high);
    next = at + 32u + lane < end ? values[at + 32u + lane] : 0u;
    uint all = subgroupBallot(kept).x;
    if (kept) stage(mine + count + bitCount(all & gl_SubgroupLtMask.x), splat);
    count += bitCount(all);
    bool is_last = at + 32u >= end;
    if (is_last && lane < AHEAD) stage_nothing(mine + count + lane);
    subgroupMemoryBarrierShared();
    subgroupBarrier();
    uint ready = (is_last ? count + AHEAD - 1u : count) / AHEAD * AHEAD;
    for (uint i = 0u; i < ready; i += AHEAD) blend(mine + i);
    if (subgroupAll(are_done())) break;
    subgroupBarrier();
    if (is_last) break;
    count -= ready;
    if (lane < count) {
      batch_place[mine + lane] = batch_place[mine + ready + lane];
      batch_rest[mine + lane] = batch_rest[mine + ready + lane];
      batch_colour[mine + lane] = batch_colour[mine + ready + lane];
    }
    subgroupBarrier();
  }
  write_pixels();
}

void main() {
  if (!find_tile()) return;
  for (uint nth = gl_SubgroupID; nth < BLOCKS; nth += SUBGROUPS) {
    draw(nth);
    subgroupBarrier();
  }
}
