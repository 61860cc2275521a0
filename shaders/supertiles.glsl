// Supertiles of SUPERTILE_SIDE x SUPERTILE_SIDE tiles, by which pairs are sorted, so that splats over several tiles make fewer
// pairs. A pair's value is its splat and, where a supertile has several tiles, above SUPERTILE_SPLAT_BITS a bit for each of them
// that the splat touches. Tiles are counted supertile by supertile, over all views, those of one row by row; at the right and
// lower edge some of them lie beyond the picture.
#include "shared/limits.h"
#include "shared/types.h"

#ifndef SUPERTILE_SIDE
#define SUPERTILE_SIDE 1
#endif
#define SUPERTILE_TILES (SUPERTILE_SIDE * SUPERTILE_SIDE)

// The tile coverage of a splat in a view, which `project` leaves for `pairs`: how many pairs it makes or, where these are in at
// most 2 x 2 supertiles of 2 x 2 tiles, IN_FEW_SUPERTILES with the first of these, counted in the view, at FEW_SHIFT, and below a
// bit for each tile, four for each supertile, row by row; so that of a small splat `pairs` need ask nothing again.
#define IN_FEW_SUPERTILES 0x80000000u
#define FEW_SHIFT 16
#define FEW_END 0x8000u  // what is in a supertile beyond is only counted

uint count_of(uint coverage) {
  if ((coverage & IN_FEW_SUPERTILES) == 0u) return coverage;
  uint any = (coverage | coverage >> 1 | coverage >> 2 | coverage >> 3) & 0x1111u;
  return uint(bitCount(any));
}

uint supertiles_across(View view) { return (view.tiles_x + uint(SUPERTILE_SIDE - 1)) / uint(SUPERTILE_SIDE); }

// The number of the tile in a column and row.
uint tile_number(uvec2 tile, View view) {
  uvec2 supertile = tile / uint(SUPERTILE_SIDE), within = tile % uint(SUPERTILE_SIDE);
  uint nth = view.supertile_offset + supertile.y * supertiles_across(view) + supertile.x;
  return nth * SUPERTILE_TILES + within.y * uint(SUPERTILE_SIDE) + within.x;
}

// The column and row of a tile by its number.
uvec2 tile_of(uint tile, View view) {
  uint supertile = tile / SUPERTILE_TILES - view.supertile_offset;
  uint nth = tile % SUPERTILE_TILES;
  return uvec2(supertile % supertiles_across(view), supertile / supertiles_across(view)) * uint(SUPERTILE_SIDE) +
         uvec2(nth % uint(SUPERTILE_SIDE), nth / uint(SUPERTILE_SIDE));
}
