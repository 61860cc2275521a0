// Lists of the splats that reach each block of a tile, for blend.comp. Each splat sets its bit in the masks of these
// blocks, and the 32 invocations of a block make its list from its mask.
#define OWN_BLOCK (gl_LocalInvocationIndex / 32u)
#define LANE (gl_LocalInvocationIndex % 32u)
shared uint masks[BLOCKS][ROUND / 32];         // by block: a bit for each splat of the batch
shared uint own_lists[BLOCKS][ROUND + AHEAD];  // by block: the splats of the batch that reach it

uint own_at(uint i) { return own_lists[OWN_BLOCK][i]; }

uvec2 place_in_tile() {
  return uvec2(OWN_BLOCK % BLOCKS_ACROSS * BLOCK_WIDTH + LANE % BLOCK_WIDTH,
               OWN_BLOCK / BLOCKS_ACROSS * BLOCK_HEIGHT + LANE / BLOCK_WIDTH * COLUMN);
}

void begin_own_block(uvec2 in_tile) {
  if (gl_LocalInvocationIndex == 0u) stage_nothing(ROUND);
  if (LANE < ROUND / 32) masks[OWN_BLOCK][LANE] = 0u;
  barrier();
}

void find_blocks(uint at, Splat splat) {
  uint bits = blocks_reached(splat, splat.mean - corner);
  for (uint block = 0u; block < BLOCKS; ++block) {
    if ((bits >> block & 1u) != 0u) atomicOr(masks[block][at / 32u], 1u << at % 32u);
  }
}

// Makes the block's list, which ends with AHEAD invisible splats, and returns its length.
uint list_own(uint in_batch) {
  uint count = 0u;
  for (uint word = 0u; word < ROUND / 32; ++word) {
    uint all = masks[OWN_BLOCK][word], before = uint(bitCount(all & (1u << LANE) - 1u));
    if ((all >> LANE & 1u) != 0u) own_lists[OWN_BLOCK][count + before] = word * 32u + LANE;
    count += uint(bitCount(all));
  }
  if (LANE < AHEAD) own_lists[OWN_BLOCK][count + LANE] = ROUND;
  barrier();
  if (LANE < ROUND / 32) masks[OWN_BLOCK][LANE] = 0u;  // main() waits before the next round sets bits
  return count;
}
