#if WITH_SUBGROUPS
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#endif
#pragma optionNV(unroll all)
// Stage 3, sort, last: a work group sorts a supertile's entries by depth, ties by splat, and writes its tiles' lists.
// It has LIST_THREADS invocations with LIST_EACH entries each. The range of depths is split into equal steps, one per
// invocation. Each step gets as many bins as it has entries, so that most bins have one or two entries. The entries of
// a bin are then compared with each other, so they may be in any order. Each of two histograms takes one atomic in
// shared memory per entry, instead of a radix sort's ballots (src/render/README.md). If many entries have nearly one
// depth, a bin has more than SORT_BIN_MAX entries. CROWDED, a later dispatch, sorts such lists by a bitonic network.
#include "shared/grid.glsl"
#include "supertiles.glsl"
#undef THREADS
#define THREADS LIST_THREADS
#include "scan_block.glsl"

layout(local_size_x = THREADS) in;

#define EACH uint(LIST_EACH)
#define MAX_ENTRIES (THREADS * EACH)
#define ROWS (THREADS / 32u)

layout(std430, binding = 0) buffer FrameCounters { Counters counters; };
layout(std430, binding = 1) readonly buffer ItemsRead { uvec4 items_read[]; };  // sort_items.glsl
#if CROWDED
layout(std430, binding = 2) coherent buffer Entries { uvec2 entries[]; };
#else
layout(std430, binding = 2) readonly buffer Entries { uvec2 entries[]; };
#endif
layout(std430, binding = 3) readonly buffer SlabTiles { uint slab_tiles[]; };     // sort_split.comp
layout(std430, binding = 5) writeonly buffer TileValues { uint tile_values[]; };  // splats
uniform uint kind;  // the kind of the lists to sort
#define ITEMS_BINDING 8
#include "sort_items.glsl"
#include "tile_ranges.glsl"  // bindings 6 and 7
uniform uint capacity;  // of tile_values

shared uint board[MAX_ENTRIES];  // in turn: entries by bin, first place by bin, keys, sorted entries
shared uint steps[THREADS];  // by step: number of earlier bins; its own number of bins from bit 16 on
shared uint low, high, of_tiles, list_begin, is_tied, is_crowded;
shared uint of_rows[ROWS][LIST_TILES], of_list[LIST_TILES];
#if !WITH_SUBGROUPS
shared uint touching[ROWS][EACH][LIST_TILES];
#endif

// Writes the tiles' lists from the sorted entries on the board.
void write_lists(uvec4 item) {
  uint self = gl_LocalInvocationIndex, row = self / 32u, lane = self % 32u, length = item.z;
  uint value[EACH];
  // Each row of 32 invocations takes EACH times 32 entries: it counts the entries of each tile, then writes them.
  uint from = row * 32u * EACH + lane;
  for (uint i = 0u; i < EACH; ++i) value[i] = from + 32u * i < length ? board[from + 32u * i] : 0u;
#if WITH_SUBGROUPS
#define TOUCHING(i, tile) subgroupBallot(TOUCHES(value[i], tile)).x
#else
#define TOUCHING(i, tile) touching[row][i][tile]
  for (uint k = lane; k < EACH * LIST_TILES; k += 32u) touching[row][k / LIST_TILES][k % LIST_TILES] = 0u;
  memoryBarrierShared();
  barrier();
  for (uint i = 0u; i < EACH; ++i)
    for (uint tile = 0u; tile < LIST_TILES; ++tile)
      if (TOUCHES(value[i], tile)) atomicOr(touching[row][i][tile], 1u << lane);
  memoryBarrierShared();
  barrier();
#endif
  uint sum = 0u;  // each lane of a row counts one tile
#if WITH_SUBGROUPS
  for (uint tile = 0u; tile < LIST_TILES; ++tile) {
    uint touched = 0u;
    for (uint i = 0u; i < EACH; ++i) touched += uint(bitCount(TOUCHING(i, tile)));
    if (lane == tile) sum = touched;
  }
#else
  if (lane < LIST_TILES)
    for (uint i = 0u; i < EACH; ++i) sum += uint(bitCount(TOUCHING(i, lane)));
#endif
  if (lane < LIST_TILES) of_rows[row][lane] = sum;
  memoryBarrierShared();
  barrier();
  uint before = 0u;
  sum = 0u;
  if (lane < LIST_TILES) {
    for (uint r = 0u; r < ROWS; ++r) {
      uint touched = of_rows[r][lane];
      sum += touched;
      before += r < row ? touched : 0u;
    }
    if (row == 0u) of_list[lane] = sum;
  }
  memoryBarrierShared();
  barrier();
  if (lane < LIST_TILES) {
    uint begin = list_begin;
    for (uint tile = 0u; tile < LIST_TILES; ++tile) begin += tile < lane ? of_list[tile] : 0u;
    if (is_slab(item)) begin = slab_tiles[(item.w & ~SLAB) * LIST_TILES + lane];
    else if (row == 0u) {
      set_range(item, lane, begin, sum);
      if (begin + sum > capacity) atomicOr(counters.overflow, OVERFLOW_TILE_PAIRS);
    }
    of_rows[row][lane] = begin + before;
  }
  memoryBarrierShared();
  barrier();
  for (uint tile = 0u; tile < LIST_TILES; ++tile) {
    uint next = of_rows[row][tile];
    for (uint i = 0u; i < EACH; ++i) {
      uint all = TOUCHING(i, tile), at = next + uint(bitCount(all & (1u << lane) - 1u));
      if (TOUCHES(value[i], tile) && at < capacity) tile_values[at] = SPLAT_OF(value[i]) + tile / SUPERTILE_TILES * frame.slots;
      next += uint(bitCount(all));
    }
  }
}

#if CROWDED
// Sorts by depth, then by splat, in the buffer. Each merge first compares mirrored halves. So all comparisons have the
// same direction, and any length is possible.
void sort_list(uvec4 item) {
  uint self = gl_LocalInvocationIndex, in_tiles = 0u;
  if (self == 0u) of_tiles = 0u;
  for (uint size = 2u; size < 2u * item.z; size *= 2u) {
    for (uint stride = size / 2u; stride > 0u; stride /= 2u) {
      for (uint k = self; k < MAX_ENTRIES / 2u; k += THREADS) {
        uint first = k / stride * 2u * stride + k % stride;
        uint second = stride == size / 2u ? first / size * size + size - 1u - first % size : first + stride;
        if (second >= item.z) continue;
        uvec2 a = entries[item.y + first], b = entries[item.y + second];
        if (a.x < b.x || (a.x == b.x && a.y < b.y)) continue;
        entries[item.y + first] = b;
        entries[item.y + second] = a;
      }
      memoryBarrierBuffer();
      barrier();
    }
  }
  for (uint i = self; i < item.z; i += THREADS) {
    board[i] = entries[item.y + i].y;
    in_tiles += uint(bitCount(TILES_OF(board[i])));
  }
  atomicAdd(of_tiles, in_tiles);
  memoryBarrierShared();
  barrier();
  if (self == 0u) list_begin = is_slab(item) ? 0u : atomicAdd(counters.tile_pairs, of_tiles);
  memoryBarrierShared();
  barrier();
  write_lists(item);
}

#else
// Sets `low` and `high` to the smallest and the largest key of all entries.
void find_range(uint key[EACH], uint length) {
  uint self = gl_LocalInvocationIndex, least = 0xFFFFFFFFu, most = 0u;
  if (self == 0u) {
    low = 0xFFFFFFFFu;
    high = 0u;
  }
  memoryBarrierShared();
  barrier();
  for (uint i = 0u; i < EACH; ++i) {
    if (i * THREADS + self >= length) continue;
    least = min(least, key[i]);
    most = max(most, key[i]);
  }
#if WITH_SUBGROUPS
  least = subgroupMin(least);
  most = subgroupMax(most);
  if (gl_SubgroupInvocationID == 0u)
#endif
  {
    atomicMin(low, least);
    atomicMax(high, most);
  }
  memoryBarrierShared();
  barrier();
}

void sort_list(uvec4 item) {
  uint self = gl_LocalInvocationIndex, length = item.z;
  uint key[EACH], value[EACH], place[EACH];
  for (uint i = 0u; i < EACH; ++i) {
    uint at = i * THREADS + self;
    uvec2 entry = at < length ? entries[item.y + at] : uvec2(0xFFFFFFFFu, 0u);
    key[i] = entry.x;
    value[i] = entry.y;
  }
  for (uint i = 0u; i < EACH; ++i) board[i * THREADS + self] = 0u;
  steps[self] = 0u;
  if (self == 0u) of_tiles = is_tied = is_crowded = 0u;
  find_range(key, length);
  uint in_tiles = 0u;
  for (uint i = 0u; i < EACH; ++i) in_tiles += uint(bitCount(TILES_OF(value[i])));
#if WITH_SUBGROUPS
  in_tiles = subgroupAdd(in_tiles);
  if (gl_SubgroupInvocationID == 0u)
#endif
  atomicAdd(of_tiles, in_tiles);
  if (low == high) {  // all depths are equal: sorts by splat
    for (uint i = 0u; i < EACH; ++i) key[i] = SPLAT_OF(value[i]);
    memoryBarrierShared();
    barrier();
    find_range(key, length);
  }
  uint least = low;
  precise float scale = float(THREADS) / (float(high - least) + 1.0);
  uint step[EACH];
  float within[EACH];
  for (uint i = 0u; i < EACH; ++i) {
    precise float at = float(key[i] - least) * scale;
    step[i] = min(uint(at), THREADS - 1u);
    precise float rest = at - float(step[i]);
    within[i] = rest;
    if (i * THREADS + self < length) atomicAdd(steps[step[i]], 1u);
  }
  memoryBarrierShared();
  barrier();
  uint in_step = steps[self], before_step = scan_group(in_step);
  steps[self] = before_step | in_step << 16;
  memoryBarrierShared();
  barrier();
  for (uint i = 0u; i < EACH; ++i) {
    if (i * THREADS + self >= length) continue;
    uint bins = steps[step[i]];
    place[i] = (bins & 0xFFFFu) + min(uint(within[i] * float(bins >> 16)), (bins >> 16) - 1u);
    place[i] |= atomicAdd(board[place[i]], 1u) << 16;
  }
  memoryBarrierShared();
  barrier();
  uint own[EACH], of_own = 0u;
  for (uint i = 0u; i < EACH; ++i) {
    own[i] = board[self * EACH + i];
    of_own += own[i];
    if (own[i] > SORT_BIN_MAX) is_crowded = 1u;
  }
  uint start = scan_group(of_own);
  for (uint i = 0u; i < EACH; ++i) {
    board[self * EACH + i] = start;
    start += own[i];
  }
  memoryBarrierShared();
  barrier();
  if (is_crowded != 0u) {
    if (self == 0u) add_item(SORT_CROWDED_KIND, make_room(SORT_CROWDED_KIND, 1u), item);
    return;
  }
  uint begin = 0u;  // of a list that is no slab; requested early, because the atomic takes long
  if (self == 0u && !is_slab(item)) begin = atomicAdd(counters.tile_pairs, of_tiles);
  uint bin[EACH];  // first place in the bin; its count from bit 16 on
  for (uint i = 0u; i < EACH; ++i) {
    bin[i] = 0u;
    if (i * THREADS + self >= length) continue;
    uint at = place[i] & 0xFFFFu, first = board[at];
    bin[i] = first | (at + 1u < MAX_ENTRIES ? board[at + 1u] : length) - first << 16;
    place[i] = first + (place[i] >> 16);
  }
  memoryBarrierShared();
  barrier();
  for (uint i = 0u; i < EACH; ++i)
    if (i * THREADS + self < length) board[place[i]] = key[i];
  memoryBarrierShared();
  barrier();
  for (uint i = 0u; i < EACH; ++i) {
    uint first = bin[i] & 0xFFFFu, count = bin[i] >> 16;
    bin[i] = 0u;
    if (count <= 1u) continue;
    uint less = 0u, as_far = 0u, earlier = 0u;
    for (uint k = first; k < first + count; ++k) {
      less += board[k] < key[i] ? 1u : 0u;
      as_far += board[k] == key[i] ? 1u : 0u;
      earlier += board[k] == key[i] && k < place[i] ? 1u : 0u;
    }
    place[i] = first + less + earlier;
    if (as_far <= 1u) continue;
    bin[i] = first + less | as_far << 16;  // now of the entries with this depth
    is_tied = 1u;
  }
  if (self == 0u) list_begin = begin;
  memoryBarrierShared();
  barrier();
  for (uint i = 0u; i < EACH; ++i)
    if (i * THREADS + self < length) board[place[i]] = value[i];
  memoryBarrierShared();
  barrier();
  if (is_tied != 0u) {
    for (uint i = 0u; i < EACH; ++i) {
      if (bin[i] == 0u) continue;
      uint first = bin[i] & 0xFFFFu, count = bin[i] >> 16, was = place[i];
      place[i] = first;
      for (uint k = first; k < first + count; ++k)  // a splat may have two entries without tiles
        place[i] += board[k] < value[i] || board[k] == value[i] && k < was ? 1u : 0u;
    }
    memoryBarrierShared();
    barrier();
    for (uint i = 0u; i < EACH; ++i)
      if (bin[i] != 0u) board[place[i]] = value[i];
    memoryBarrierShared();
    barrier();
  }
  write_lists(item);
}
#endif

// There is one work group per list, up to the limit of a dispatch.
void main() {
  if ((counters.overflow & OVERFLOW_UNSORTED) != 0u) return;
  uint count = counters.lists[kind].count;
  for (uint nth = gl_WorkGroupID.x; nth < count; nth += gl_NumWorkGroups.x) {
    sort_list(items_read[kind * item_capacity + nth]);
    memoryBarrierShared();
    barrier();
  }
}
