// Which tiles of a view a splat is offered to (METHOD 4). A shape is a file beside this one with two functions:
//   uvec4 tile_box(Splat, View)                      columns [x, z) and rows [y, w) that it can touch, inside the grid
//   uvec2 tile_row(Splat, View, uvec4 box, uint row) columns [x, y) that it does touch in one of those rows
// Counting and emission call the same code and must agree to the bit, so everything that decides is `precise`.
#include "shared/axes.h"
#include "shared/limits.h"
#include "shared/types.h"

// First and one-past-last tile along an axis for pixels [low, high]; beyond the grid is cut off. Clamped as floats, since
// int() of a huge float is anything.
uvec2 tile_span(float low, float high, uint tiles) {
  float first = clamp(ceil((low - float(TILE_SIZE - 1)) / float(TILE_SIZE)), 0.0, float(tiles));
  float last = clamp(floor(high / float(TILE_SIZE)), -1.0, float(tiles) - 1.0);
  return uvec2(uint(first), max(uint(first), uint(last + 1.0)));
}

#if TILES == TILES_AABB
#include "tiles/aabb.glsl"
#elif TILES == TILES_ELLIPSE
#include "tiles/ellipse.glsl"
#else
// TILES_ALL: one pair a view, whose tiles share one list of all its splats.
uvec4 tile_box(Splat splat, View view) { return uvec4(0u, 0u, 1u, 1u); }
uvec2 tile_row(Splat splat, View view, uvec4 box, uint row) { return box.xz; }
#endif

uint tile_count(Splat splat, View view) {
  uvec4 box = tile_box(splat, view);
  uint count = 0u;
  for (uint row = box.y; row < box.w; ++row) {
    uvec2 columns = tile_row(splat, view, box, row);
    count += columns.y - columns.x;
  }
  return count;
}

bool touches_a_tile(Splat splat, View view) {
  uvec4 box = tile_box(splat, view);
  for (uint row = box.y; row < box.w; ++row) {
    uvec2 columns = tile_row(splat, view, box, row);
    if (columns.y > columns.x) return true;
  }
  return false;
}
