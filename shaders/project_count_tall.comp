#if WITH_SUBGROUPS
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#endif
// Stage 1, project, last part: the pairs of splats of many rows and of wide ones, which project.comp left aside. A work group
// takes TALL_EACH of them and its invocations share their rows, so that none waits for the one with the tallest.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "shared/saturate.glsl"
#include "primitives/scan_block.glsl"
#include "slots.glsl"
#include "tiles/tiles.glsl"
#include "splats.glsl"  // binding 12

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Views { View views[]; };
layout(std430, binding = 1) readonly buffer FrameCounters { Counters counters; };
layout(std430, binding = 2) readonly buffer Tall { uint tall[]; };  // splats
layout(std430, binding = 4) writeonly buffer Coverages { uint coverages[]; };  // (slot, view): supertiles.glsl

shared uvec4 box_at[TALL_EACH];
shared uint pairs_at[TALL_EACH];
shared uint rows_before[THREADS];

void main() {
  uint self = gl_LocalInvocationIndex;
  uint first = group_index() * TALL_EACH;
  if (first >= counters.tall) return;
  bool has_one = self < TALL_EACH && first + self < counters.tall;
  uint rows = 0u;
  if (has_one) {
    uint splat = tall[first + self];
    View view = views[view_of(splat)];
    uvec4 box = box_of_tiles(outline_of(SPLAT(splat), view), view);
    box_at[self] = box;
    pairs_at[self] = 0u;
    rows = supertile_rows(box).y - supertile_rows(box).x;
  }
  rows_before[self] = scan_group(rows);
  barrier();
  for (uint nth = self; nth < group_total(); nth += THREADS) {
    LAST_BEFORE(rows_before, nth, at)
    uint splat = tall[first + at];
    uvec4 box = box_at[at];
    uint row = supertile_rows(box).x + nth - rows_before[at];
    View view = views[view_of(splat)];
    uvec2 columns = supertile_row(outline_of(SPLAT(splat), view), view, box, row).columns;
    atomicAdd(pairs_at[at], columns.y - columns.x);
  }
  barrier();
  if (has_one) {
    uint splat = tall[first + self];
    coverages[slot_of(splat) * frame.view_count + view_of(splat)] = pairs_at[self];
  }
}
