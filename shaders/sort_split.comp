#if WITH_SUBGROUPS
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#endif
// Stage 3, sort, for lists too long for a work group (sort_items.glsl). A work group splits a list into slabs by depth,
// or by splat if all depths are equal. It stores the place of each slab's first splat in each tile's list. It appends
// slabs to the lists to sort, or to split in the next round. Each round moves entries to the buffer's other half.
#include "shared/grid.glsl"
#include "supertiles.glsl"
#undef THREADS
#define THREADS 1024
#include "scan_block.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) buffer FrameCounters { Counters counters; };
layout(std430, binding = 1) buffer Entries { uvec2 entries[]; };
layout(std430, binding = 2) buffer SlabTiles { uint slab_tiles[]; };              // by slab and tile
layout(std430, binding = 5) readonly buffer ItemsRead { uvec4 items_read[]; };
#define ITEMS_BINDING 4
#include "sort_items.glsl"
#include "tile_ranges.glsl"  // bindings 6 and 7
uniform uint round;        // from 0
uniform uint first_entry;  // of the other half of the buffer
uniform uint capacity;     // room for the splats of all tiles' lists

#define STEPS (2u * THREADS)  // steps of depth; a step is not divided
shared uint steps[STEPS];      // by step: number of entries, then place of the next entry
shared uint slab_of[STEPS];
shared uint slab_begin[SORT_SLABS];
shared uint slab_sums[SORT_SLABS][LIST_TILES];
shared uint totals[LIST_TILES];
shared uint low, high, first_slab, list_begin;

uint key_of(uvec2 entry, bool by_splat) { return by_splat ? SPLAT_OF(entry.y) : entry.x; }

void find_range(uvec4 item, bool by_splat) {
  if (gl_LocalInvocationIndex == 0u) {
    low = 0xFFFFFFFFu;
    high = 0u;
  }
  memoryBarrierShared();
  barrier();
  uint least = 0xFFFFFFFFu, most = 0u;
  for (uint at = gl_LocalInvocationIndex; at < item.z; at += THREADS) {
    uint key = key_of(entries[item.y + at], by_splat);
    least = min(least, key);
    most = max(most, key);
  }
  atomicMin(low, least);
  atomicMax(high, most);
  memoryBarrierShared();
  barrier();
}

void split_list(uvec4 item) {
  uint self = gl_LocalInvocationIndex, length = item.z;
  uint slab_length = max(SORT_MAX / 2u, (length + SORT_SLABS - 1u) / SORT_SLABS);
  steps[self] = steps[self + THREADS] = 0u;
  if (self < SORT_SLABS) {
    slab_begin[self] = length;
    for (uint tile = 0u; tile < LIST_TILES; ++tile) slab_sums[self][tile] = 0u;
  }
  find_range(item, false);
  bool by_splat = low == high;
  if (by_splat) {
    memoryBarrierShared();
    barrier();
    find_range(item, true);
  }
  uint least = low;
  precise float scale = float(STEPS) / (float(high - least) + 1.0);
#define STEP_OF(entry) min(uint(float(key_of(entry, by_splat) - least) * scale), STEPS - 1u)
  for (uint at = self; at < length; at += THREADS) atomicAdd(steps[STEP_OF(entries[item.y + at])], 1u);
  memoryBarrierShared();
  barrier();
  uint first = steps[2u * self], second = steps[2u * self + 1u], before = scan_group(first + second);
  for (uint k = 0u; k < 2u; ++k) {
    // A step's middle selects its slab. So a step longer than a slab becomes a slab, and every round shortens lists.
    uint count = k == 0u ? first : second, slab = min((before + count / 2u) / slab_length, SORT_SLABS - 1u);
    steps[2u * self + k] = before;
    slab_of[2u * self + k] = slab;
    if (count != 0u) atomicMin(slab_begin[slab], before);
    before += count;
  }
  memoryBarrierShared();
  barrier();
  uint other = round % 2u == 0u ? item.y + first_entry : item.y - first_entry;
  for (uint at = self; at < length; at += THREADS) {
    uvec2 entry = entries[item.y + at];
    uint step = STEP_OF(entry);
    entries[other + atomicAdd(steps[step], 1u)] = entry;
    for (uint tile = 0u; tile < LIST_TILES; ++tile)
      if (TOUCHES(entry.y, tile)) atomicAdd(slab_sums[slab_of[step]][tile], 1u);
  }
  memoryBarrierShared();
  barrier();
  if (self < LIST_TILES) {
    uint sum = 0u;
    for (uint slab = 0u; slab < SORT_SLABS; ++slab) sum += slab_sums[slab][self];
    totals[self] = sum;
  }
  memoryBarrierShared();
  barrier();
  if (self == 0u) {
    uint in_tiles = 0u;
    for (uint tile = 0u; tile < LIST_TILES; ++tile) in_tiles += totals[tile];
    first_slab = atomicAdd(counters.slabs, SORT_SLABS);
    list_begin = is_slab(item) ? 0u : atomicAdd(counters.tile_pairs, in_tiles);
    if (!is_slab(item) && list_begin + in_tiles > capacity) atomicOr(counters.overflow, OVERFLOW_TILE_PAIRS);
  }
  memoryBarrierShared();
  barrier();
  if (self < LIST_TILES) {
    uint begin = list_begin;
    for (uint tile = 0u; tile < self; ++tile) begin += totals[tile];
    if (!is_slab(item)) set_range(item, self, begin, totals[self]);
    else begin = slab_tiles[(item.w & ~SLAB) * LIST_TILES + self];
    for (uint slab = 0u; slab < SORT_SLABS; ++slab) {
      slab_tiles[(first_slab + slab) * LIST_TILES + self] = begin;
      begin += slab_sums[slab][self];
    }
  }
  if (self < SORT_SLABS && slab_begin[self] < length) {  // slabs without entries have no begin
    uint end = length;
    for (uint slab = self + 1u; slab < SORT_SLABS; ++slab) end = min(end, slab_begin[slab]);
    uint count = end - slab_begin[self], kind = kind_of(count, round + 1u);
    add_item(kind, make_room(kind, 1u), uvec4(item.x, other + slab_begin[self], count, SLAB | (first_slab + self)));
  }
}

void main() {
  if ((counters.overflow & OVERFLOW_UNSORTED) != 0u) return;
  uint kind = SORT_LONG_KIND + round, count = counters.lists[kind].count;
  for (uint nth = gl_WorkGroupID.x; nth < count; nth += gl_NumWorkGroups.x) {
    split_list(items_read[kind * item_capacity + nth]);
    memoryBarrierShared();
    barrier();
  }
}
