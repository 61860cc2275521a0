#if WITH_SUBGROUPS
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#endif
// Stage 3, pairs: (supertile, splat) for every supertile of a tile that a splat touches, in depth order. A work group makes
// SCAN_BLOCK pairs. Its invocations take a splat each; of those in few supertiles they write the pairs at once, and share what leads to the
// others: a splat each counts its rows of supertiles, then a row finds its tiles, then pairs. However many rows and tiles
// a Gaussian covers, the work is spread evenly.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "shared/saturate.glsl"
#if WITH_SUBGROUPS  // with fewer in a group, fewer wait for the last (README.md of render)
#undef THREADS
#define THREADS 128
#endif
#include "primitives/scan_block.glsl"
#include "slots.glsl"
#include "tiles/tiles.glsl"
#include "splats.glsl"  // binding 12

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer OrderArguments { DispatchArguments order_arguments[]; };
layout(std430, binding = 1) readonly buffer PairArguments { DispatchArguments pair_arguments[]; };
layout(std430, binding = 2) readonly buffer Views { View views[]; };
layout(std430, binding = 3) readonly buffer Order { uint order[]; };
layout(std430, binding = 4) readonly buffer PairOffsets { uint pair_offsets[]; };  // scanned
layout(std430, binding = 5) readonly buffer CoverageInOrder { uint coverage_in_order[]; };  // (rank, view of the group)
layout(std430, binding = 7) writeonly buffer Keys { uint keys[]; };      // supertile, counted over all views
layout(std430, binding = 8) writeonly buffer Values { uint values[]; };  // supertiles.glsl
uniform uint view_begin;
uniform uint view_end;

#define NO_SPLAT 0xFFFFFFFFu
shared uint found;
shared uint any_many[3];  // by batch in turn: whether a splat of it is in more than a few supertiles
// Of the splats held: which, where their pairs begin, their tile boxes (here and below two numbers of 16 bits a word), and the
// rows before each.
shared uint splat_at[THREADS];
shared uint start_at[THREADS];
shared uvec2 box_at[THREADS];
shared uint rows_before[THREADS];
// Of the rows at hand: the place of their splats above, and the columns of tiles in their one or two rows of tiles. Each array
// less leaves room for more groups at a time, so what can be found again is not kept (README.md).
shared uint row_place[THREADS];
shared uint row_tiles[SUPERTILE_SIDE][THREADS];

// The last rank whose pairs begin at or before `pair`, looked for by all invocations together.
uint rank_of(uint pair) {
  uint low = 0u;
  uint size = order_arguments[0].count;
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

// The pairs [first, end) of a splat of a view in few supertiles, whose own begin at `start`.
void make_few(uint splat, View view, uint coverage, uint start, uint first, uint end) {
  uint supertile = view.supertile_offset + ((coverage & ~IN_FEW_SUPERTILES) >> FEW_SHIFT);
  uint across = supertiles_across(view);
  for (uint nth = 0u; nth < 4u; ++nth) {
    uint tiles = coverage >> 4u * nth & 15u;
    if (tiles == 0u) continue;
    if (start >= first && start < end) {
      keys[pair_arguments[0].first + start] = supertile + nth % 2u + nth / 2u * across;
      values[pair_arguments[0].first + start] = splat | tiles << SUPERTILE_SPLAT_BITS;
    }
    ++start;
  }
}

// This invocation's splat, from `rank` on, view after view, and where its pairs begin, if it makes some of the pairs [first, end)
// and is in more than a few supertiles; the pairs of one in few are made.
bool take_splat(uint rank, uint first, uint end, out uint splat, out uint start) {
  uint self = gl_LocalInvocationIndex;
  uint in_views = view_end - view_begin;
  rank += self / in_views;
  if (self >= THREADS / in_views * in_views || rank >= order_arguments[0].count) return false;
  uint nth = self % in_views;
  splat = splat_of(order[rank], view_begin + nth);
  uint coverage = coverage_in_order[rank * in_views + nth];
  start = pair_offsets[rank];
  for (uint k = 0u; k < nth; ++k) start += count_of(coverage_in_order[rank * in_views + k]);
  if (start >= end || start + count_of(coverage) <= first) return false;
#if SUPERTILE_SIDE == 2
  if ((coverage & IN_FEW_SUPERTILES) != 0u) {
    make_few(splat, views[view_begin + nth], coverage, start, first, end);
    return false;
  }
#endif
  return coverage != 0u;
}

uvec4 box_of(uint place) { return uvec4(box_at[place] & 0xFFFFu, box_at[place] >> 16); }

// The pairs of the nth row of the splats held.
uint take_row(uint nth) {
  LAST_BEFORE(rows_before, nth, at)
  uint self = gl_LocalInvocationIndex;
  uint splat = splat_at[at];
  uvec4 box = box_of(at);
  View view = views[view_of(splat)];
  SupertileRow row =
      supertile_row(outline_of(SPLAT(splat), view), view, box, supertile_rows(box).x + nth - rows_before[at]);
  row_place[self] = at;
  row_tiles[0][self] = row.tiles.x | row.tiles.y << 16;
#if SUPERTILE_SIDE == 2
  row_tiles[1][self] = row.tiles.z | row.tiles.w << 16;
#endif
  return row.columns.y - row.columns.x;
}

SupertileRow row_at(uint at) {
  uvec2 tiles = uvec2(row_tiles[0][at], row_tiles[SUPERTILE_SIDE - 1][at]);
  return supertile_row_of(uvec4(tiles.x & 0xFFFFu, tiles.x >> 16, tiles.y & 0xFFFFu, tiles.y >> 16));
}

uint sum_before(uint at) { return at == 0u ? 0u : scan_sums[at - 1u]; }

// Of the rows at hand, from nth_row on, the first of the splat at `place`.
uint first_row(uint place, uint nth_row) { return max(rows_before[place], nth_row) - nth_row; }

// Pair `to`, the nth of the row at `at`, the nth_row of the splats held.
void make_pair(uint to, uint nth_row, uint at, uint nth) {
  uint place = row_place[at];
  uint splat = splat_at[place];
  SupertileRow row = row_at(at);
  uint column = row.columns.x + nth;
#if TILES == TILES_ALL
  keys[to] = view_of(splat);  // one list a view
#else
  uint v = view_of(splat);
  uint row_in_view = supertile_rows(box_of(place)).x + nth_row - rows_before[place];
  keys[to] = views[v].supertile_offset + row_in_view * supertiles_across(views[v]) + column;
#endif
  values[to] = value_of(splat, row, column);
}

// The pairs [first, end) of the splats held, which are in depth order.
void make_many(uint held, uint first, uint end) {
  uint self = gl_LocalInvocationIndex;
  uint rows = 0u;
  if (self < held && splat_at[self] != NO_SPLAT) {
    View view = views[view_of(splat_at[self])];
    uvec4 box = box_of_tiles(outline_of(SPLAT(splat_at[self]), view), view);
    box_at[self] = box.xy | box.zw << 16;
    rows = supertile_rows(box).y - supertile_rows(box).x;
  }
  rows_before[self] = scan_group(rows);
  rows = take_group_total();
  uint made = 0u;  // of the splat that the rows at hand begin with, by those before
  for (uint row = 0u; row < rows; row += THREADS) {
    scan_group(row + self < rows ? take_row(row + self) : 0u);
    uint pairs = take_group_total();
    if (rows_before[row_place[0]] == row) made = 0u;
    // Only of the first splat there can be pairs before `first`.
    uint from = start_at[row_place[0]] + made;
    uint skipped = first > from ? first - from : 0u;
    for (uint nth = skipped + self; nth < min(pairs, end - from); nth += THREADS) {
      FIRST_AFTER(scan_sums, nth, at)
#if SUPERTILE_SIDE == 1
      uint to = from + nth;  // none was made at once in between
#else
      uint place = row_place[at];
      uint in_splat = nth - sum_before(first_row(place, row)) + (rows_before[place] < row ? made : 0u);
      uint to = start_at[place] + in_splat;
#endif
      if (to < end) make_pair(pair_arguments[0].first + to, row + at, at, nth - sum_before(at));
    }
    uint last = row_place[min(rows - row, THREADS) - 1u];
    made = pairs - sum_before(first_row(last, row)) + (rows_before[last] < row ? made : 0u);
    if (start_at[last] + made >= end) break;
    memoryBarrierShared();
    barrier();
  }
  memoryBarrierShared();
  barrier();
}

void main() {
  uint self = gl_LocalInvocationIndex;
  uint first = group_index() * SCAN_BLOCK;
  uint end = min(first + SCAN_BLOCK, pair_arguments[0].count);
  if (first >= end) return;
  if (self == 0u) any_many[0] = 0u;
  uint ranks = THREADS / (view_end - view_begin);  // at a time
  uint rank = rank_of(first);
  memoryBarrierShared();
  barrier();
  uint held = 0u;
  for (uint batch = 0u;; ++batch, rank += ranks) {
    uint splat, start;
    bool is_many = take_splat(rank, first, end, splat, start);
#if SUPERTILE_SIDE == 1  // all are
    splat_at[self] = is_many ? splat : NO_SPLAT;
    start_at[self] = start;
    memoryBarrierShared();
    barrier();
    make_many(THREADS, first, end);
#else
    if (is_many) any_many[batch % 3u] = 1u;
    if (self == 0u) any_many[(batch + 1u) % 3u] = 0u;
    memoryBarrierShared();
    barrier();
    if (any_many[batch % 3u] != 0u) {
      uint place = scan_group(is_many ? 1u : 0u);
      uint count = take_group_total();
      if (held + count > THREADS) {
        make_many(held, first, end);
        held = 0u;
      }
      if (is_many) {
        splat_at[held + place] = splat;
        start_at[held + place] = start;
      }
      held += count;
    }
#endif
    if (rank + ranks >= order_arguments[0].count || pair_offsets[rank + ranks] >= end) break;
  }
#if SUPERTILE_SIDE == 2
  memoryBarrierShared();
  barrier();
  make_many(held, first, end);
#endif
}
