#if WITH_SUBGROUPS
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#endif
// Stage 2, bin: the entries of splats in many supertiles and of wide ones, which project.comp left aside. A work group takes
// LARGE_EACH of them and its invocations share their rows, so that none waits for the one with the most. The entries go behind
// those that bin.comp is to place, each with its supertile, in any order.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "scan_block.glsl"
#include "slots.glsl"
#include "tiles/tiles.glsl"
#include "splats.glsl"  // binding 12

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Views { View views[]; };
layout(std430, binding = 1) buffer FrameCounters { Counters counters; };
layout(std430, binding = 2) readonly buffer Large { uint large[]; };            // splats
layout(std430, binding = 3) writeonly buffer Coverages { uint coverages[]; };   // by splat: supertiles.glsl
layout(std430, binding = 4) buffer SupertileCounts { uint supertile_counts[]; };
layout(std430, binding = 5) writeonly buffer Entries { uvec2 entries[]; };
uniform uint first_entry;  // of those that it makes
uniform uint capacity;     // and how many there is room for

// Of the splats: their tile boxes, whether they touch any tile, the rows before each.
shared uvec4 box_at[LARGE_EACH];
shared uint touches[LARGE_EACH];
shared uint rows_before[LARGE_EACH];
shared uint row_count;
// Of the rows at hand: their splats, first supertiles, columns of tiles (two of 16 bits a word), and the entries before each.
shared uint row_splat[THREADS];
shared uint row_supertile[THREADS];
shared uvec2 row_tiles[THREADS];
shared uint made_before[THREADS];
shared uint made, first_made;

void main() {
  uint self = gl_LocalInvocationIndex;
  uint first = group_index() * LARGE_EACH;
  if (first >= counters.large) return;
  bool has_one = self < LARGE_EACH && first + self < counters.large;
  uint rows = 0u;
  if (has_one) {
    uint splat = large[first + self];
    View view = views[view_of(splat)];
    uvec4 box = box_of_tiles(outline_of(SPLAT(splat), view), view);
    box_at[self] = box;
    touches[self] = 0u;
    rows = supertile_rows(box).y - supertile_rows(box).x;
  }
  uint before = scan_group(rows);
  if (self < LARGE_EACH) rows_before[self] = before;
  if (self == LARGE_EACH - 1u) row_count = before + rows;
  memoryBarrierShared();
  barrier();
  for (uint begin = 0u; begin < row_count; begin += THREADS) {
    uint nth = begin + self, count = 0u;
    if (nth < row_count) {
      uint at = 0u;  // the last splat whose rows begin at or before this one
      for (uint half_way = LARGE_EACH / 2u; half_way > 0u; half_way /= 2u) at += rows_before[at + half_way] <= nth ? half_way : 0u;
      uint splat = large[first + at], row_in_view = supertile_rows(box_at[at]).x + nth - rows_before[at];
      View view = views[view_of(splat)];
      SupertileRow row = supertile_row(outline_of(SPLAT(splat), view), view, box_at[at], row_in_view);
      row_splat[self] = splat;
      row_supertile[self] = view.supertile_offset + row_in_view * supertiles_across(view);
      row_tiles[self] = uvec2(row.tiles.x | row.tiles.y << 16, row.tiles.z | row.tiles.w << 16);
      count = row.columns.y - row.columns.x;
      if (count != 0u) touches[at] = 1u;
    }
    made_before[self] = scan_group(count);
    if (self == THREADS - 1u) {
      made = made_before[self] + count;
      first_made = atomicAdd(counters.large_entries, made);
      if (first_made + made > capacity) atomicOr(counters.overflow, OVERFLOW_LARGE);
      if (first_made + made > COUNT_MAX / 2u) atomicOr(counters.overflow, OVERFLOW_COUNT);
    }
    memoryBarrierShared();
    barrier();
    for (uint n = self; n < made; n += THREADS) {
      uint at = 0u;  // the last row whose entries begin at or before this one
      for (uint half_way = THREADS / 2u; half_way > 0u; half_way /= 2u) at += made_before[at + half_way] <= n ? half_way : 0u;
      uvec2 tiles = row_tiles[at];
      SupertileRow row = supertile_row_of(uvec4(tiles.x & 0xFFFFu, tiles.x >> 16, tiles.y & 0xFFFFu, tiles.y >> 16));
      uint column = row.columns.x + n - made_before[at], supertile = row_supertile[at] + column;
      atomicAdd(supertile_counts[supertile], 1u);
      if (first_made + n < capacity) entries[first_entry + first_made + n] = uvec2(supertile, entry_of(row_splat[at], row, column));
    }
    memoryBarrierShared();
    barrier();
  }
  if (has_one && touches[self] == 0u) coverages[large[first + self]] = 0u;
}
