// A subgroup that draws a whole tile: all splats of the tile's list reach its block. Part of blend_subgroups.comp.
const uint sure = 0u;  // there are no meshes

uint own_at(uint i) { return i; }
uint blocks_of(Splat splat) { return 1u; }
void keep_blocks(uint at, uint bits) {
  if (bits == 0u) stage_nothing(at);
}

uint list_own(uint in_batch) { return in_batch; }
