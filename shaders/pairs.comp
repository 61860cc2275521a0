#if WITH_SUBGROUPS
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#endif
// Stage 3, pairs: (list, splat) for every list of a tile that a splat touches, in depth order. A work group makes SCAN_BLOCK
// pairs, and its invocations share what leads to them: first each takes a splat and counts its rows of lists, then a row and
// finds its tiles, then pairs. However many rows and tiles a Gaussian covers, the work is spread evenly.
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
layout(std430, binding = 5) readonly buffer PairCounts { uint pair_counts[]; };
layout(std430, binding = 7) writeonly buffer Keys { uint keys[]; };      // list, counted over all views
layout(std430, binding = 8) writeonly buffer Values { uint values[]; };  // lists.glsl, of the splat slot * view_count + view
uniform uint view_count;  // of the frame
uniform uint view_begin;
uniform uint view_end;

shared uint found;
// Of the splats at hand: which, their tile boxes (here and below two numbers of 16 bits a word), and the rows before each.
shared uint splat_at[THREADS];
shared uvec2 box_at[THREADS];
shared uint rows_before[THREADS];
// Of the rows at hand: the place of their splats above, and the columns of tiles in their one or two rows of tiles. Each array
// less leaves room for more groups at a time, so what can be found again is not kept (README.md).
shared uint row_place[THREADS];
shared uint row_tiles[LIST_TILES][THREADS];

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
  if (pair_counts[splat] == 0u) return 0u;
  uvec4 box = tile_box(SPLAT(splat), views[v]);
  splat_at[self] = splat;
  box_at[self] = box.xy | box.zw << 16;
  uvec2 rows = list_rows(box);
  return rows.y - rows.x;
}

uvec4 box_of(uint place) { return uvec4(box_at[place] & 0xFFFFu, box_at[place] >> 16); }

// The pairs of the nth row of the splats at hand.
uint take_row(uint nth) {
  LAST_BEFORE(rows_before, nth, at)
  uint self = gl_LocalInvocationIndex;
  uint splat = splat_at[at];
  uvec4 box = box_of(at);
  ListRow row = list_row(SPLAT(splat), views[splat % view_count], box, list_rows(box).x + nth - rows_before[at]);
  row_place[self] = at;
  row_tiles[0][self] = row.tiles.x | row.tiles.y << 16;
#if LIST_TILES == 2
  row_tiles[1][self] = row.tiles.z | row.tiles.w << 16;
#endif
  return row.columns.y - row.columns.x;
}

ListRow row_at(uint at) {
  uvec2 tiles = uvec2(row_tiles[0][at], row_tiles[LIST_TILES - 1][at]);
  return list_row_of(uvec4(tiles.x & 0xFFFFu, tiles.x >> 16, tiles.y & 0xFFFFu, tiles.y >> 16));
}

// The nth pair of the row whose place is `at`, the nth_row of the splats at hand.
void make_pair(uint to, uint nth_row, uint at, uint nth) {
  uint place = row_place[at];
  uint splat = splat_at[place];
  ListRow row = row_at(at);
  uint column = row.columns.x + nth;
#if TILES == TILES_ALL
  keys[to] = splat % view_count;  // one list a view
#else
  uint v = splat % view_count;
  uint row_in_view = list_rows(box_of(place)).x + nth_row - rows_before[place];
  keys[to] = views[v].list_offset + row_in_view * lists_across(views[v]) + column;
#endif
  values[to] = value_of(splat, row, column);
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
      scan_group(row + self < rows ? take_row(row + self) : 0u);
      uint pairs = take_group_total();
      uint skipped = first > pair ? first - pair : 0u;  // by the groups before
      for (uint made = skipped + self; made < min(pairs, end - pair); made += THREADS) {
        FIRST_AFTER(scan_sums, made, at)
        make_pair(pair_amounts[0].first + pair + made, row + at, at, at == 0u ? made : made - scan_sums[at - 1u]);
      }
      pair += pairs;
      memoryBarrierShared();
      barrier();
    }
  }
}
