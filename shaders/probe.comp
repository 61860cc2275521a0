// After the blend, for --quality: sums the squared difference between a view and its probe in the probe's tiles. Both
// pictures are rounded to 8 bits. Also sums, over work groups, the square of each group's total error: these
// squares measure how much the error differs between tiles. A group's THREADS pixels are a tile of 16 px. Counts the
// pairs of these tiles in both. One invocation per pixel of the probe's tiles.
#include "shared/grid.glsl"
#include "shared/bytes.glsl"
#include "supertiles.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Views { View views[]; };
layout(std430, binding = 1) readonly buffer Colours { vec4 colours[]; };  // C, and the final T
layout(std430, binding = 2) buffer FrameCounters { Counters counters; };
layout(std430, binding = 3) readonly buffer Ranges { uvec2 ranges[]; };  // begin, end
#include "frame.glsl"

shared float sums[THREADS];

vec3 shown(uint pixel) {
  return in_bytes(colours[pixel].rgb + colours[pixel].a * frame.background.rgb) / 255.0;
}

float squared_error(uint nth) {
  View probe = views[frame.requested_views], probed = views[frame.probed_view];
  const uint side = uint(TILE_SIZE);
  uvec2 tile = uvec2(nth / (side * side) % probe.tiles_x, nth / (side * side) / probe.tiles_x);
  uvec2 in_tile = uvec2(nth % side, nth / side % side);
  uvec2 kept = tile * side + in_tile;
  uvec2 at = tile * probe.pitch + uvec2(probe.shift_x, probe.shift_y) + in_tile;
  if (tile.y >= probe.tiles_y || at.x >= probe.width || at.y >= probe.height) return 0.0;
  if (in_tile == uvec2(0u) && frame.list_per_view == 0u) {
    uvec2 own = ranges[tile_number(tile, probe)], of_view = ranges[tile_number(at / side, probed)];
    atomicAdd(counters.probe_pairs, own.y - own.x);
    atomicAdd(counters.probed_pairs, of_view.y - of_view.x);
  }
  vec3 d = shown(probe.pixel_offset + kept.y * probe.tiles_x * side + kept.x) -
           shown(probed.pixel_offset + at.y * probe.width + at.x);
  return dot(d, d);
}

void main() {
  uint self = gl_LocalInvocationIndex;
  sums[self] = squared_error(thread_index());
  barrier();
  for (uint half_way = THREADS / 2u; half_way > 0u; half_way /= 2u) {
    if (self < half_way) sums[self] += sums[self + half_way];
    barrier();
  }
  if (self != 0u) return;
  // Integers, so the order of additions does not matter.
  uint sum = uint(sums[0] * float(PROBE_SCALE));
  uint before = atomicAdd(counters.probe_low, sum);
  if (before + sum < before) atomicAdd(counters.probe_high, 1u);
  uint square = uint(min(sums[0] * sums[0], 1000.0) * float(PROBE_SCALE));
  before = atomicAdd(counters.probe_squares_low, square);
  if (before + square < before) atomicAdd(counters.probe_squares_high, 1u);
}
