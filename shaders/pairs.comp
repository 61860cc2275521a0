// Stage 3, pairs: (tile, splat) for every tile that a splat touches, in depth order. A work group makes SCAN_BLOCK pairs, and
// its invocations share what leads to them: first each takes a splat and counts its rows, then a row and finds its tiles,
// then pairs. However many rows and tiles a Gaussian covers, the work is spread evenly.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "shared/saturate.glsl"
#include "primitives/scan_block.glsl"
#include "tiles/tiles.glsl"
#include "splats.glsl"  // binding 12

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer OrderAmounts { Amount order_amounts[]; };
layout(std430, binding = 1) readonly buffer PairAmounts { Amount pair_amounts[]; };
layout(std430, binding = 2) readonly buffer Views { View views[]; };
layout(std430, binding = 3) readonly buffer Order { uint order[]; };
layout(std430, binding = 4) readonly buffer PairOffsets { uint pair_offsets[]; };  // scanned
layout(std430, binding = 5) readonly buffer TileCounts { uint tile_counts[]; };
layout(std430, binding = 7) writeonly buffer Keys { uint keys[]; };      // tile, counted over all views
layout(std430, binding = 8) writeonly buffer Values { uint values[]; };  // splat: slot * view_count + view
uniform uint view_count;  // of the frame
uniform uint view_begin;
uniform uint view_end;

shared uint found;
// Of the splats at hand: which, their tile boxes (two numbers of 16 bits a word), and the rows before each.
shared uint splat_at[THREADS];
shared uvec2 box_at[THREADS];
shared uint rows_before[THREADS];
// Of the rows at hand: splat, first tile, and the tiles before each.
shared uint row_splat[THREADS];
shared uint row_tile[THREADS];
shared uint tiles_before[THREADS];

// The last rank whose pairs begin at or before `pair`, looked for by all invocations together.
uint rank_of(uint pair) {
  uint low = 0u;
  uint size = order_amounts[0].count;
  while (size > 1u) {
    if (gl_LocalInvocationIndex == 0u) found = low;
    barrier();
    uint step = (size + THREADS - 1u) / THREADS;
    uint at = gl_LocalInvocationIndex * step;
    if (at < size && pair_offsets[low + at] <= pair) atomicMax(found, low + at);
    barrier();
    size = min(step, low + size - found);
    low = found;
    barrier();
  }
  return low;
}

// The rows of the nth splat from `rank` on, view after view; 0 where there is none.
uint take_splat(uint rank, uint nth) {
  uint self = gl_LocalInvocationIndex;
  uint in_views = view_end - view_begin;
  rank += nth / in_views;
  if (rank >= order_amounts[0].count) return 0u;
  uint v = view_begin + nth % in_views;
  uint splat = order[rank] * view_count + v;
  if (tile_counts[splat] == 0u) return 0u;
  uvec4 box = tile_box(SPLAT(splat), views[v]);
  splat_at[self] = splat;
  box_at[self] = box.xy | box.zw << 16;
  return box.w - box.y;
}

// The tiles of the nth row of the splats at hand.
uint take_row(uint nth) {
  LAST_BEFORE(rows_before, nth, at)
  uint self = gl_LocalInvocationIndex;
  uint splat = splat_at[at];
  uint v = splat % view_count;
  View view = views[v];
  uvec4 box = uvec4(box_at[at] & 0xFFFFu, box_at[at] >> 16);
  uint row = box.y + nth - rows_before[at];
  uvec2 columns = tile_row(SPLAT(splat), view, box, row);
  row_splat[self] = splat;
#if TILES == TILES_ALL
  row_tile[self] = v;  // one list a view
#else
  row_tile[self] = view.tile_offset + row * view.tiles_x + columns.x;
#endif
  return columns.y - columns.x;
}

void main() {
  uint self = gl_LocalInvocationIndex;
  uint first = group_index() * SCAN_BLOCK;
  uint end = min(first + SCAN_BLOCK, pair_amounts[0].count);
  if (first >= end) return;
  uint rank = rank_of(first);
  uint pair = pair_offsets[rank];  // the first that the rows at hand make
  uint splats_left = (order_amounts[0].count - rank) * (view_end - view_begin);
  for (uint nth = 0u; pair < end && nth < splats_left; nth += THREADS) {
    uint before = scan_group(take_splat(rank, nth + self));
    rows_before[self] = before;
    uint rows = take_group_total();
    for (uint row = 0u; row < rows && pair < end; row += THREADS) {
      before = scan_group(row + self < rows ? take_row(row + self) : 0u);
      tiles_before[self] = before;
      uint tiles = take_group_total();
      uint skipped = first > pair ? first - pair : 0u;  // by the groups before
      for (uint tile = skipped + self; tile < min(tiles, end - pair); tile += THREADS) {
        LAST_BEFORE(tiles_before, tile, at)
        uint to = pair_amounts[0].first + pair + tile;
        keys[to] = row_tile[at] + tile - tiles_before[at];
        values[to] = row_splat[at];
      }
      pair += tiles;
      barrier();
    }
  }
}
