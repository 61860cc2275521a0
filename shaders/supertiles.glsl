// Supertiles of SUPERTILE_SIDE x SUPERTILE_SIDE tiles, by which splats are binned and sorted: an entry is a splat in a supertile, its
// number with, above SUPERTILE_SPLAT_BITS, a bit for each of the tiles that it touches. Tiles are counted supertile by supertile,
// over all views, those of one row by row; at the right and lower edge some of them lie beyond the picture.
#include "shared/limits.h"
#include "shared/types.h"

#define SUPERTILE_TILES uint(SUPERTILE_SIDE * SUPERTILE_SIDE)
#define SPLAT_OF(entry) ((entry) & (1u << SUPERTILE_SPLAT_BITS) - 1u)
#define TOUCHES(entry, tile) (((entry) >> SUPERTILE_SPLAT_BITS >> (tile) & 1u) != 0u)

// The tile coverage of a splat, which `project` leaves for `bin`: 0 of one that touches no tile; IN_FEW_SUPERTILES where it is in at
// most 2 x 2 supertiles, with the first of these, counted in the view, at FEW_SHIFT, and below a bit for each tile, four for each
// supertile, row by row; or IN_MANY_SUPERTILES, whose entries bin_large.comp makes.
#define IN_FEW_SUPERTILES 0x80000000u
#define FEW_SHIFT 16
#define FEW_END 0x8000u  // what is in a supertile beyond counts as in many
#define IN_MANY_SUPERTILES 1u

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
