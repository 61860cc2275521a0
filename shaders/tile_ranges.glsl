// Stores the range of each tile's list, in stage sort. Also collects the tiles with long lists, for a separate dispatch
// of the blend that starts first, with more invocations per tile. The including file declares `counters`.
#include "frame.glsl"

layout(std430, binding = 6) writeonly buffer TileRanges { uvec2 tile_ranges[]; };  // begin, end
layout(std430, binding = 7) writeonly buffer LongLists { uint long_lists[]; };    // tiles

// Stores the range of the nth tile of a list that is no slab.
void set_range(uvec4 item, uint nth, uint begin, uint length) {
  if (nth >= SUPERTILE_TILES && item.w == NO_SECOND) return;
  uint tile = (nth < SUPERTILE_TILES ? item.x : item.w) * SUPERTILE_TILES + nth % SUPERTILE_TILES;
  tile_ranges[tile] = uvec2(begin, begin + length);
  if (length <= LONG_LIST || frame.list_per_view != 0u) return;
  uint place = atomicAdd(counters.long_lists, 1u);
  long_lists[place] = tile;
  atomicMax(counters.long_x, min(place + 1u, LONG_ROW));
  if (place % LONG_ROW == 0u) atomicMax(counters.long_y, place / LONG_ROW + 1u);
  counters.long_z = 1u;
}
