// Supertiles of SUPERTILE_SIDE x SUPERTILE_SIDE tiles, by which splats are binned and sorted. Tiles are counted supertile by
// supertile, over all views, those of one row by row; at the right and lower edge some of them lie beyond the picture.
#include "shared/limits.h"
#include "shared/types.h"

#define SUPERTILE_TILES uint(SUPERTILE_SIDE * SUPERTILE_SIDE)

// An entry is a splat in a list of a supertile: its number and, below it, a bit for each tile of the list that it touches. With
// LIST_VIEWS 2 both eyes share a list, since what one sees the other mostly does: of a supertile of the first eye and of the one in
// the same row of the second that lies View::lists_shift columns before it, round the edge. The number is the first eye's splat.
#define LIST_TILES (SUPERTILE_TILES * uint(LIST_VIEWS))
#define SPLAT_OF(entry) ((entry) >> LIST_TILES)
#define TILES_OF(entry) ((entry) & (1u << LIST_TILES) - 1u)
#define TOUCHES(entry, tile) (((entry) >> (tile) & 1u) != 0u)

// The tile coverage of a splat, which `project` leaves for `bin`: 0 of one that touches no tile; IN_FEW_SUPERTILES where it is in at
// most 2 x 2 supertiles, with the list of the first of these, counted in the view, at FEW_SHIFT, and below a bit for each tile, four
// for each supertile, row by row; or IN_MANY_SUPERTILES, whose entries bin_large.comp makes; so is one whose lists
// lie round the edge, and one that is in many of the other eye's, if they share lists.
#define IN_FEW_SUPERTILES 0x80000000u
#define FEW_SHIFT 16
#define FEW_END 0x8000u  // what is in a supertile beyond counts as in many
#define IN_MANY_SUPERTILES 1u
#define LARGE_EACH (LARGE_VIEWS / uint(LIST_VIEWS))  // splats whose entries a work group makes

uint supertiles_across(View view) { return (view.tiles_x + uint(SUPERTILE_SIDE - 1)) / uint(SUPERTILE_SIDE); }

// Of a column of a view's supertiles, the column of the lists.
uint column_of_list(uint column, View view) {
  uint moved = column + view.lists_shift, across = supertiles_across(view);
  return moved < across ? moved : moved - across;
}

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
