#if WITH_SUBGROUPS
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#endif
#pragma optionNV(unroll all)
// Stage 5, ranges, where supertiles are of several tiles: each tile's own list out of its supertile's, those of every supertile's
// first tile first, then those of the second, and so on. A work group takes TILE_BLOCK sorted pairs, and a row of 32 invocations,
// a subgroup where WITH_SUBGROUPS, EACH times 32 of them. Without WRITES it counts its block's by tile; with it, once these are
// scanned, it writes them, and where a list begins or ends.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "shared/arguments.glsl"
#include "supertiles.glsl"

#define ROWS 8
#define EACH (TILE_BLOCK / 32 / ROWS)
layout(local_size_x = 32, local_size_y = ROWS) in;

layout(std430, binding = 0) readonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 1) readonly buffer Values { uint values[]; };  // supertiles.glsl
#if WRITES
layout(std430, binding = 2) readonly buffer TileCounts { uint tile_counts[]; };  // by tile of a supertile, then by block; scanned
layout(std430, binding = 3) readonly buffer Total { uint total[]; };
layout(std430, binding = 4) readonly buffer Keys { uint keys[]; };               // supertiles
layout(std430, binding = 5) writeonly buffer TileRanges { uint tile_ranges[]; };
layout(std430, binding = 6) writeonly buffer TileValues { uint tile_values[]; };  // splats
layout(std430, binding = 7) buffer FrameCounters { Counters counters; };
uniform uint capacity;
#else
layout(std430, binding = 2) writeonly buffer TileCounts { uint tile_counts[]; };
#endif

shared uint row_counts[ROWS][SUPERTILE_TILES];
#if !WITH_SUBGROUPS
shared uint touching[ROWS][EACH][SUPERTILE_TILES];
#endif

bool touches(uint value, uint nth) { return (value >> SUPERTILE_SPLAT_BITS >> nth & 1u) != 0u; }

void main() {
  uint count = arguments[0].count;
  uint block = group_index(), blocks = blocks_of(count, TILE_BLOCK);
  if (block >= blocks) return;
  uint lane = gl_LocalInvocationID.x, row = gl_LocalInvocationID.y;
  uint begin = block * TILE_BLOCK + row * 32u * EACH + lane;
  uint value[EACH];
  for (uint k = 0u; k < EACH; ++k) value[k] = begin + 32u * k < count ? values[begin + 32u * k] : 0u;
  // Of each 32 values and tile, a bit for each that touches it.
  uint all[EACH][SUPERTILE_TILES];
#if WITH_SUBGROUPS
  for (uint k = 0u; k < EACH; ++k)
    for (uint nth = 0u; nth < SUPERTILE_TILES; ++nth) all[k][nth] = subgroupBallot(touches(value[k], nth)).x;
#else
  if (lane < EACH * SUPERTILE_TILES) touching[row][lane / SUPERTILE_TILES][lane % SUPERTILE_TILES] = 0u;
  barrier();
  for (uint k = 0u; k < EACH; ++k)
    for (uint nth = 0u; nth < SUPERTILE_TILES; ++nth)
      if (touches(value[k], nth)) atomicOr(touching[row][k][nth], 1u << lane);
  barrier();
  for (uint k = 0u; k < EACH; ++k)
    for (uint nth = 0u; nth < SUPERTILE_TILES; ++nth) all[k][nth] = touching[row][k][nth];
#endif
  for (uint nth = 0u; nth < SUPERTILE_TILES; ++nth) {
    uint sum = 0u;
    for (uint k = 0u; k < EACH; ++k) sum += bitCount(all[k][nth]);
    if (lane == 0u) row_counts[row][nth] = sum;
  }
  memoryBarrierShared();
  barrier();
#if WRITES
  if (block == 0u && lane == 0u && row == 0u) {
    counters.tile_pairs = total[0];
    if (total[0] > capacity) atomicOr(counters.overflow, OVERFLOW_TILE_PAIRS);
  }
  uint to[SUPERTILE_TILES];
  for (uint nth = 0u; nth < SUPERTILE_TILES; ++nth) {
    to[nth] = tile_counts[nth * blocks + block];
    for (uint r = 0u; r < ROWS; ++r) to[nth] += r < row ? row_counts[r][nth] : 0u;
  }
  for (uint k = 0u; k < EACH; ++k) {
    uint at = begin + 32u * k;
    if (at >= count) break;
    uint supertile = keys[at];
    bool is_first = at == 0u || keys[at - 1u] != supertile;
    bool is_last = at + 1u == count || keys[at + 1u] != supertile;
    for (uint nth = 0u; nth < SUPERTILE_TILES; ++nth) {
      uint place = to[nth] + bitCount(all[k][nth] & ((1u << lane) - 1u));
      bool is_one = touches(value[k], nth);
      if (is_one && place < capacity) tile_values[place] = value[k] & ((1u << SUPERTILE_SPLAT_BITS) - 1u);
      if (is_first) tile_ranges[2u * (supertile * SUPERTILE_TILES + nth)] = place;
      if (is_last) tile_ranges[2u * (supertile * SUPERTILE_TILES + nth) + 1u] = is_one ? place + 1u : place;
      to[nth] += bitCount(all[k][nth]);
    }
  }
#else
  if (row == 0u && lane < SUPERTILE_TILES) {
    uint sum = 0u;
    for (uint r = 0u; r < ROWS; ++r) sum += row_counts[r][lane];
    tile_counts[lane * blocks + block] = sum;
  }
#endif
}
