// The lists of a tile's blocks, in order. Part of blend_subgroups.comp.
#define WORDS (ROUND / 32)

shared uint reached[ROUND];                    // by splat of the batch: the blocks that it reaches
shared uint own_lists[BLOCKS][ROUND + AHEAD];  // by block: the splats of the batch that reach it
uint sure;

uint own_at(uint i) { return own_lists[gl_SubgroupID][i]; }
uint blocks_of(Splat splat) { return blocks_reached(splat, splat.mean - corner); }
void keep_blocks(uint at, uint bits) { reached[at] = bits; }

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

uint list_own(uint in_batch) {
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
