// Stage 2, bin: moves the entries of bin_large.comp to their supertiles' places. One invocation per entry. Neighbouring
// entries are in different supertiles, so their global atomics rarely wait for each other.
#include "shared/grid.glsl"
#include "splat_places.glsl"
#include "supertiles.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Views { View views[]; };
layout(std430, binding = 1) readonly buffer FrameCounters { Counters counters; };
layout(std430, binding = 3) buffer SupertileEnds { uint supertile_ends[]; };  // by supertile: place of the next entry
layout(std430, binding = 4) readonly buffer Depths { uint depths[]; };        // (order group, slot): splat_places.glsl
layout(std430, binding = 5) buffer Entries { uvec2 entries[]; };  // moved: (depth, entry); before: (supertile, entry)
uniform uint first_entry;

void main() {
  uint nth = thread_index();
  if (nth >= counters.large_entries || counters.overflow != 0u) return;
  uvec2 made = entries[first_entry + nth];
  uint splat = SPLAT_OF(made.y);
  entries[atomicAdd(supertile_ends[made.x], 1u)] = uvec2(DEPTH_OF(splat, views[view_of(splat)]), made.y);
}
