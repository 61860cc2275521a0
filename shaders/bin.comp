// Stage 2, bin: the entries of splats in few supertiles, for a view, or for both eyes if they share lists. Without
// FILLS it counts each supertile's entries; with FILLS it writes the entries to their places. A work group first counts
// in shared memory: neighbouring splats are often in one supertile, and global atomics would wait for each other.
#include "shared/grid.glsl"
#include "splat_places.glsl"
#include "supertiles.glsl"

layout(local_size_x = BIN_THREADS) in;

layout(std430, binding = 0) readonly buffer Views { View views[]; };
layout(std430, binding = 1) readonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 2) readonly buffer Coverages { uint coverages[]; };  // by splat: supertiles.glsl
#if FILLS
layout(std430, binding = 3) buffer SupertileEnds { uint supertile_ends[]; };  // by supertile: place of the next entry
layout(std430, binding = 4) readonly buffer Depths { uint depths[]; };        // (order group, slot): splat_places.glsl
layout(std430, binding = 5) writeonly buffer Entries { uvec2 entries[]; };    // depth, entry
layout(std430, binding = 6) readonly buffer FrameCounters { Counters counters; };
#else
layout(std430, binding = 3) buffer SupertileCounts { uint supertile_counts[]; };
#endif
uniform uint view_index;       // the view, or the first of two that share lists
uniform uint first_supertile;  // the dispatch covers SUPERTILES supertiles of the view from here on

#define EACH (BIN_BLOCK / BIN_THREADS)
shared uint bins[SUPERTILES];  // by supertile: the number of entries; then, with FILLS, the place of the next entry

#define ENTRIES (4u * uint(LIST_VIEWS))  // the largest number of entries of a splat
uint across;                             // supertiles in a row
uint coverage[EACH][LIST_VIEWS];

uint supertile_of(uint coverage, uint nth) { return ((coverage & ~IN_FEW_SUPERTILES) >> FEW_SHIFT) + nth % 2u + nth / 2u * across; }
uint tiles_of(uint coverage, uint nth) { return nth < 4u ? coverage >> 4u * nth & 15u : 0u; }

// The nth entry of this invocation's splat k: the supertile, counted from first_supertile, and its tiles as bits. If no
// bit is set, there is no entry.
uvec2 entry_of(uint k, uint nth) {
  uint supertile = supertile_of(coverage[k][nth / 4u], nth % 4u), tiles = tiles_of(coverage[k][nth / 4u], nth % 4u);
#if LIST_VIEWS == 2
  // An entry of the first eye's supertiles has both eyes' tiles. Elsewhere the second eye has separate entries.
  uint before = supertile - supertile_of(coverage[k][1u - nth / 4u], 0u);
  uint same = before < 2u ? before : before - across < 2u ? before - across + 2u : 4u;
  if (nth < 4u) tiles |= tiles_of(coverage[k][1], same) << SUPERTILE_TILES;
  else tiles = same < 4u ? 0u : tiles << SUPERTILE_TILES;
#endif
  return uvec2(supertile - first_supertile, tiles);
}

void main() {
  uint count = arguments[0].count, self = gl_LocalInvocationIndex;
  uint first = group_index() * BIN_BLOCK;
  if (first >= count) return;
#if FILLS
  if (counters.overflow != 0u) return;
#endif
  View view = views[view_index];
  across = supertiles_across(view);
  uint offset = view.supertile_offset + first_supertile;
  for (uint b = self; b < SUPERTILES; b += BIN_THREADS) bins[b] = 0u;
  for (uint k = 0u; k < EACH; ++k) {
    uint slot = first + k * BIN_THREADS + self;
    for (uint eye = 0u; eye < uint(LIST_VIEWS); ++eye) {
      bool is_there = slot < count && view_index + eye < frame.view_count;
      coverage[k][eye] = is_there ? coverages[splat_of(slot, view_index + eye)] : 0u;
      if ((coverage[k][eye] & IN_FEW_SUPERTILES) == 0u) coverage[k][eye] = 0u;
    }
  }
  memoryBarrierShared();
  barrier();
  for (uint k = 0u; k < EACH; ++k) {
    for (uint nth = 0u; nth < ENTRIES; ++nth) {
      uvec2 entry = entry_of(k, nth);
      if (entry.y != 0u && entry.x < SUPERTILES) atomicAdd(bins[entry.x], 1u);
    }
  }
  memoryBarrierShared();
  barrier();
  for (uint b = self; b < SUPERTILES; b += BIN_THREADS) {
    if (bins[b] == 0u) continue;
#if FILLS
    bins[b] = atomicAdd(supertile_ends[offset + b], bins[b]);
#else
    atomicAdd(supertile_counts[offset + b], bins[b]);
#endif
  }
#if FILLS
  memoryBarrierShared();
  barrier();
  for (uint k = 0u; k < EACH; ++k) {
    uint any = 0u;
    for (uint eye = 0u; eye < uint(LIST_VIEWS); ++eye) any |= coverage[k][eye];
    if (any == 0u) continue;
    uint splat = splat_of(first + k * BIN_THREADS + self, view_index), depth = DEPTH_OF(splat, view);
    for (uint nth = 0u; nth < ENTRIES; ++nth) {
      uvec2 entry = entry_of(k, nth);
      if (entry.y != 0u && entry.x < SUPERTILES)
        entries[atomicAdd(bins[entry.x], 1u)] = uvec2(depth, splat << LIST_TILES | entry.y);
    }
  }
#endif
}
