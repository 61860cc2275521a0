// Stage 5: where each tile's list begins and ends among the sorted pairs. Tiles without pairs keep the zeros written by
// ranges_clear.comp.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 1) readonly buffer Keys { uint keys[]; };
layout(std430, binding = 2) buffer Ranges { uint ranges[]; };  // begin, end of each tile

void main() {
  uint at = thread_index();
  uint count = arguments[0].count;
  if (at >= count) return;
  uint tile = keys[at];
  if (at == 0u || keys[at - 1u] != tile) ranges[2u * tile] = at;
  if (at + 1u == count || keys[at + 1u] != tile) ranges[2u * tile + 1u] = at + 1u;
}
