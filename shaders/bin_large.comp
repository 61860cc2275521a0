#if WITH_SUBGROUPS
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#endif
// Stage 2, bin: makes the entries of wide splats and of splats in many supertiles (`large` of project.comp). A work
// group takes LARGE_EACH splats, and divides their rows among its invocations, so that none waits for the largest
// splat. Entries go behind the room for bin.comp's entries, in any order, with their supertile instead of a depth.
#include "shared/grid.glsl"
#include "scan_block.glsl"
#include "splat_places.glsl"
#include "tiles/tiles.glsl"
#include "splats.glsl"  // binding 12

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Views { View views[]; };
layout(std430, binding = 1) buffer FrameCounters { Counters counters; };
layout(std430, binding = 2) readonly buffer Large { uint large[]; };   // splats; one for both eyes if they share lists
layout(std430, binding = 3) buffer Coverages { uint coverages[]; };     // by splat: supertiles.glsl
layout(std430, binding = 4) buffer SupertileCounts { uint supertile_counts[]; };
layout(std430, binding = 5) writeonly buffer Entries { uvec2 entries[]; };
uniform uint first_entry;  // place of the first entry that this shader makes
uniform uint capacity;     // room for the entries that this shader makes

#define EYE_COUNT uint(LIST_VIEWS)
#define ROWS (THREADS / EYE_COUNT)  // rows of supertiles at a time: one invocation per row and eye
// By splat: each eye's box of tiles, and whether the eye's splat touches any tile; the first row of supertiles; the
// number of rows of earlier splats.
shared uvec4 box_at[LARGE_EACH][EYE_COUNT];
shared uint touches[LARGE_EACH][EYE_COUNT];
shared uint first_row[LARGE_EACH];
shared uint rows_before[LARGE_EACH];
shared uint row_count;
// By row of supertiles: the splat; the row's first supertile; each eye's columns of tiles, two of 16 bits in a word;
// the number of entries of earlier rows.
shared uint row_splat[ROWS];
shared uint row_supertile[ROWS];
shared uvec2 row_tiles[ROWS][EYE_COUNT];
shared uint made_before[ROWS];
shared uint made, first_made;

SupertileRow row_at(uint at, uint eye) {
  uvec2 tiles = row_tiles[at][eye];
  return supertile_row_of(uvec4(tiles.x & 0xFFFFu, tiles.x >> 16, tiles.y & 0xFFFFu, tiles.y >> 16));
}

// The number of columns of supertiles by which an eye is shifted, so that both eyes' columns of a splat are adjacent.
// Shifted columns may exceed a row. A second eye's shift of over half a row stands for a negative shift; then the first
// eye is also shifted, by a full row.
uint moved_by(uint first_view, uint eye) {
  if (first_view + 1u >= frame.view_count) return 0u;
  uint across = supertiles_across(views[first_view]), shift = LIST_VIEWS == 2 ? views[first_view + 1u].lists_shift : 0u;
  return eye == 1u ? shift : shift > across / 2u ? across : 0u;
}

#if LIST_VIEWS == 2
// Whether the columns of both eyes form one range without a gap.
bool are_one(uvec2 a, uvec2 b) { return max(a.x, b.x) <= min(a.y, b.y); }
#endif

void main() {
  uint self = gl_LocalInvocationIndex;
  uint first = group_index() * LARGE_EACH;
  if (first >= counters.large_splats) return;
  uint nth_of_all = first + self / EYE_COUNT, eye = self % EYE_COUNT;
  if (self < LARGE_EACH * EYE_COUNT) {
    uvec4 box = uvec4(0u);
    if (nth_of_all < counters.large_splats) {
      uint splat = large[nth_of_all], v = view_of(splat) + eye;
      splat += eye * frame.slots;
      if (v < frame.view_count && coverages[splat] != 0u) box = box_of_tiles(outline_of(SPLAT(splat), views[v]), views[v]);
    }
    box_at[self / EYE_COUNT][eye] = box;
    touches[self / EYE_COUNT][eye] = 0u;
  }
  memoryBarrierShared();
  barrier();
  uint rows = 0u;
  if (self < LARGE_EACH) {
    uvec2 of_all = uvec2(0xFFFFFFFFu, 0u);
    for (uint k = 0u; k < EYE_COUNT; ++k) {
      uvec2 of_view = supertile_rows(box_at[self][k]);
      if (of_view.x < of_view.y) of_all = uvec2(min(of_all.x, of_view.x), max(of_all.y, of_view.y));
    }
    first_row[self] = of_all.x;
    rows = max(of_all.x, of_all.y) - of_all.x;
  }
  uint before = scan_group(rows);
  if (self < LARGE_EACH) rows_before[self] = before;
  if (self == LARGE_EACH - 1u) row_count = before + rows;
  memoryBarrierShared();
  barrier();
  for (uint begin = 0u; begin < row_count; begin += ROWS) {
    uint nth = begin + self / EYE_COUNT;
    uvec2 tiles = uvec2(0u);
    if (nth < row_count) {
      uint at = 0u;  // the last splat whose rows begin at or before row nth
      for (uint half_way = LARGE_EACH / 2u; half_way > 0u; half_way /= 2u) at += rows_before[at + half_way] <= nth ? half_way : 0u;
      uint splat = large[first + at], in_view = first_row[at] + nth - rows_before[at];
      uvec4 box = box_at[at][eye];
      uvec2 of_view = supertile_rows(box);
      View view = views[min(view_of(splat) + eye, frame.view_count - 1u)];
      if (in_view >= of_view.x && in_view < of_view.y) {
        SupertileRow row = supertile_row(outline_of(SPLAT(splat + eye * frame.slots), view), view, box, in_view);
        uvec4 moved = row.tiles + moved_by(view_of(splat), eye) * uint(SUPERTILE_SIDE);
        if (row.columns.x != row.columns.y) {
          touches[at][eye] = 1u;
          tiles = uvec2(moved.x | moved.y << 16, moved.z | moved.w << 16);
        }
      }
      if (eye == 0u) {
        row_splat[self / EYE_COUNT] = splat;
        row_supertile[self / EYE_COUNT] = view.supertile_offset + in_view * supertiles_across(view);
      }
    }
    row_tiles[self / EYE_COUNT][eye] = tiles;
    memoryBarrierShared();
    barrier();
    uint count = 0u;
    if (self < ROWS) {
      uvec2 columns = row_at(self, 0u).columns;
      count = columns.y - columns.x;
#if LIST_VIEWS == 2
      uvec2 second = row_at(self, 1u).columns;
      count = are_one(columns, second) ? max(columns.y, second.y) - min(columns.x, second.x) : count + second.y - second.x;
#endif
    }
    uint before_row = scan_group(count);
    if (self < ROWS) made_before[self] = before_row;
    if (self == ROWS - 1u) {
      made = before_row + count;
      first_made = atomicAdd(counters.large_entries, made);
      if (first_made + made > capacity) atomicOr(counters.overflow, OVERFLOW_LARGE);
      if (first_made + made > COUNT_MAX / 2u) atomicOr(counters.overflow, OVERFLOW_COUNT);
    }
    memoryBarrierShared();
    barrier();
    for (uint n = self; n < made; n += THREADS) {
      uint at = 0u;  // the last row whose entries begin at or before entry n
      for (uint half_way = ROWS / 2u; half_way > 0u; half_way /= 2u) at += made_before[at + half_way] <= n ? half_way : 0u;
      SupertileRow row = row_at(at, 0u);
      uint nth_of_row = n - made_before[at], column = row.columns.x + nth_of_row;
#if LIST_VIEWS == 2
      SupertileRow second = row_at(at, 1u);
      uint length = row.columns.y - row.columns.x, across = supertiles_across(views[view_of(row_splat[at])]);
      if (are_one(row.columns, second.columns)) column = min(row.columns.x, second.columns.x) + nth_of_row;
      else if (nth_of_row >= length) column = second.columns.x + nth_of_row - length;
      uint tiles = tiles_in(row, column) | tiles_in(second, column) << SUPERTILE_TILES;
      if (column >= across) column -= across;
#else
      uint tiles = tiles_in(row, column);
#endif
      uint supertile = row_supertile[at] + column;
      atomicAdd(supertile_counts[supertile], 1u);
      if (first_made + n < capacity) entries[first_entry + first_made + n] = uvec2(supertile, row_splat[at] << LIST_TILES | tiles);
    }
    memoryBarrierShared();
    barrier();
  }
  if (self < LARGE_EACH * EYE_COUNT && nth_of_all < counters.large_splats && touches[self / EYE_COUNT][eye] == 0u) {
    uint splat = large[nth_of_all];
    if (view_of(splat) + eye < frame.view_count) coverages[splat + eye * frame.slots] = 0u;
  }
}
