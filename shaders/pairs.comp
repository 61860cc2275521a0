// Stage 3, pairs: (tile, splat) for every tile that a splat touches, in depth order. One invocation a pair, which finds
// its Gaussian by bisection, then its tile by walking the splat's rows: however many tiles one Gaussian covers, the work
// is spread evenly.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "tiles/tiles.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer OrderAmounts { Amount order_amounts[]; };
layout(std430, binding = 1) readonly buffer PairAmounts { Amount pair_amounts[]; };
layout(std430, binding = 2) readonly buffer Views { View views[]; };
layout(std430, binding = 3) readonly buffer Order { uint order[]; };
layout(std430, binding = 4) readonly buffer PairOffsets { uint pair_offsets[]; };  // scanned
layout(std430, binding = 5) readonly buffer TileCounts { uint tile_counts[]; };
layout(std430, binding = 6) readonly buffer Splats { Splat splats[]; };
layout(std430, binding = 7) writeonly buffer Keys { uint keys[]; };      // tile, counted over all views
layout(std430, binding = 8) writeonly buffer Values { uint values[]; };  // splat: view * slots + slot
uniform uint slots;  // of one view
uniform uint view_begin;
uniform uint view_end;

// The last rank whose pairs begin at or before `pair`.
uint rank_of(uint pair) {
  uint low = 0u;
  uint high = order_amounts[0].count;
  while (high - low > 1u) {
    uint middle = (low + high) / 2u;
    if (pair_offsets[middle] <= pair) low = middle;
    else high = middle;
  }
  return low;
}

void main() {
  uint pair = thread_index();
  if (pair >= pair_amounts[0].count) return;
  uint rank = rank_of(pair);
  uint nth = pair - pair_offsets[rank];  // of the Gaussian's tiles, view after view, row after row
  uint v = view_begin;
  uint splat_index = v * slots + order[rank];
  while (v + 1u < view_end && nth >= tile_counts[splat_index]) {
    nth -= tile_counts[splat_index];
    ++v;
    splat_index += slots;
  }
  View view = views[v];
  Splat splat = splats[splat_index];
  uvec4 box = tile_box(splat, view);
  uint row = box.y;
  uvec2 columns = tile_row(splat, view, box, row);
  while (nth >= columns.y - columns.x && row + 1u < box.w) {
    nth -= columns.y - columns.x;
    columns = tile_row(splat, view, box, ++row);
  }
  uint to = pair_amounts[0].first + pair;
#if TILES == TILES_ALL
  keys[to] = v;  // one list a view
#else
  keys[to] = view.tile_offset + row * view.tiles_x + columns.x + nth;
#endif
  values[to] = splat_index;
}
