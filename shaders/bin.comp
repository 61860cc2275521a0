// Stage 2, bin: of a view's splats in few supertiles, how many are in each supertile; with FILLS the entries themselves, each to
// the place of its supertile. A work group counts the entries of BIN_BLOCK splats in shared memory first, so that neighbours, which
// often are in one supertile, do not wait for one another; of as many supertiles as it has room for, from first_supertile on.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "slots.glsl"
#include "supertiles.glsl"

layout(local_size_x = BIN_THREADS) in;

layout(std430, binding = 0) readonly buffer Views { View views[]; };
layout(std430, binding = 1) readonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 2) readonly buffer Coverages { uint coverages[]; };  // by splat: supertiles.glsl
#if FILLS
layout(std430, binding = 3) buffer SupertileEnds { uint supertile_ends[]; };  // where each one's next entry goes
layout(std430, binding = 4) readonly buffer Depths { uint depths[]; };        // (order group, slot): slots.glsl
layout(std430, binding = 5) writeonly buffer Entries { uvec2 entries[]; };    // depth, entry
layout(std430, binding = 6) readonly buffer FrameCounters { Counters counters; };
#else
layout(std430, binding = 3) buffer SupertileCounts { uint supertile_counts[]; };
#endif
uniform uint view_index;
uniform uint first_supertile;  // in the view

#define EACH (BIN_BLOCK / BIN_THREADS)
shared uint bins[SUPERTILES];  // of each supertile: entries, then with FILLS where the next one goes

uint tiles_of(uint coverage, uint nth) { return coverage >> 4u * nth & 15u; }

// Of the nth of a coverage's four supertiles; more than SUPERTILES where there is no entry for these bins.
uint bin_of(uint coverage, uint nth, uint across) {
  if (tiles_of(coverage, nth) == 0u) return 0xFFFFFFFFu;
  return ((coverage & ~IN_FEW_SUPERTILES) >> FEW_SHIFT) + nth % 2u + nth / 2u * across - first_supertile;
}

void main() {
  uint count = arguments[0].count, self = gl_LocalInvocationIndex;
  uint first = group_index() * BIN_BLOCK;
  if (first >= count) return;
#if FILLS
  if (counters.overflow != 0u) return;
#endif
  View view = views[view_index];
  uint across = supertiles_across(view), offset = view.supertile_offset + first_supertile;
  for (uint b = self; b < SUPERTILES; b += BIN_THREADS) bins[b] = 0u;
  uint coverage[EACH];
  for (uint k = 0u; k < EACH; ++k) {
    uint slot = first + k * BIN_THREADS + self;
    coverage[k] = slot < count ? coverages[splat_of(slot, view_index)] : 0u;
    if ((coverage[k] & IN_FEW_SUPERTILES) == 0u) coverage[k] = 0u;
  }
  memoryBarrierShared();
  barrier();
  for (uint k = 0u; k < EACH; ++k) {
    for (uint nth = 0u; nth < 4u; ++nth) {
      uint at = bin_of(coverage[k], nth, across);
      if (at < SUPERTILES) atomicAdd(bins[at], 1u);
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
    if (coverage[k] == 0u) continue;
    uint splat = splat_of(first + k * BIN_THREADS + self, view_index), depth = DEPTH_OF(splat, view);
    for (uint nth = 0u; nth < 4u; ++nth) {
      uint at = bin_of(coverage[k], nth, across);
      if (at < SUPERTILES)
        entries[atomicAdd(bins[at], 1u)] = uvec2(depth, splat | tiles_of(coverage[k], nth) << SUPERTILE_SPLAT_BITS);
    }
  }
#endif
}
