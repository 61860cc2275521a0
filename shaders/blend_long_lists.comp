// Stage 6, first part: the tiles whose lists are long. One invocation a tile. Their order does not matter, since each draws
// its own pixels.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Ranges { uint ranges[]; };
layout(std430, binding = 1) writeonly buffer LongLists { uint long_lists[]; };  // tiles
layout(std430, binding = 2) buffer FrameCounters { Counters counters; };
#include "frame.glsl"

void main() {
  uint tile = thread_index();
  if (tile >= frame.tile_count || ranges[2u * tile + 1u] - ranges[2u * tile] <= LONG_LIST) return;
  uint place = atomicAdd(counters.long_lists, 1u);
  long_lists[place] = tile;
  counters.long_x = LONG_ROW;
  if (place % LONG_ROW == 0u) atomicMax(counters.long_y, place / LONG_ROW + 1u);
  counters.long_z = 1u;
}
