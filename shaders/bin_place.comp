// Stage 2, bin: allocates the place of each supertile's entries, and an item for `sort` (sort_items.glsl), both in any
// order. One invocation per supertile.
#include "shared/types.h"
#include "shared/grid.glsl"
#include "shared/arguments.glsl"
#include "supertiles.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) buffer FrameCounters { Counters counters; };
layout(std430, binding = 1) buffer SupertileCounts { uint supertile_counts[]; };  // cleared for the next frame
layout(std430, binding = 2) writeonly buffer SupertileEnds { uint supertile_ends[]; };
layout(std430, binding = 3) writeonly buffer TileRanges { uvec2 tile_ranges[]; };  // begin, end
#if LIST_VIEWS == 2
#include "frame.glsl"
layout(std430, binding = 5) readonly buffer Views { View views[]; };
#endif
#define ITEMS_BINDING 4
#include "sort_items.glsl"
uniform uint supertile_count;
uniform uint capacity;  // room for entries
uniform uint groups_max;

// Returns the second eye's supertile that shares its list with this supertile of the first eye; NO_SECOND if none does.
uint second_of(uint supertile) {
#if LIST_VIEWS == 2
  uint v = 0u;
  while (v + 2u < frame.view_count && supertile >= views[v + 2u].supertile_offset) v += 2u;
  if (v + 1u == frame.view_count) return NO_SECOND;
  View view = views[v + 1u];
  uint across = supertiles_across(view), nth = supertile - views[v].supertile_offset, column = nth % across;
  return view.supertile_offset + nth - column + (column + across - view.lists_shift) % across;
#else
  return NO_SECOND;
#endif
}

shared uint of_kind[SORT_LONG_KIND + 1u], first_of_kind[SORT_LONG_KIND + 1u];
shared uint sum, base;

void main() {
  uint self = gl_LocalInvocationIndex, supertile = thread_index();
  bool is_one = supertile < supertile_count;
  uint count = is_one ? supertile_counts[supertile] : 0u;
  if (is_one) supertile_counts[supertile] = 0u;
  if (self <= SORT_LONG_KIND) of_kind[self] = 0u;
  if (self == 0u) sum = 0u;
  memoryBarrierShared();
  barrier();
  uint kind = 0u, place = 0u, first = 0u;
  if (count != 0u) {
    kind = kind_of(count, 0u);
    place = atomicAdd(of_kind[kind], 1u);
    first = atomicAdd(sum, count);
  }
  memoryBarrierShared();
  barrier();
  if (self <= SORT_LONG_KIND) first_of_kind[self] = of_kind[self] == 0u ? 0u : make_room(self, of_kind[self]);
  if (self == 0u) {
    base = atomicAdd(counters.pairs, sum);
    if (base + sum > capacity) atomicOr(counters.overflow, OVERFLOW_PAIRS);
    if (group_index() == 0u) {  // for bin_fill_large.comp
      uvec2 groups = split_groups(blocks_of(counters.large_entries, THREADS), groups_max);
      counters.fill_x = groups.x;
      counters.fill_y = groups.y;
      counters.fill_z = 1u;
    }
  }
  memoryBarrierShared();
  barrier();
  if (!is_one) return;
  supertile_ends[supertile] = base + first;
  if (count != 0u) add_item(kind, first_of_kind[kind] + place, uvec4(supertile, base + first, count, second_of(supertile)));
  else for (uint tile = 0u; tile < SUPERTILE_TILES; ++tile) tile_ranges[supertile * SUPERTILE_TILES + tile] = uvec2(0u);
}
