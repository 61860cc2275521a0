// Supertiles of SUPERTILE_SIDE x SUPERTILE_SIDE tiles, by which splats are binned and sorted. Tiles are numbered
// supertile by supertile over all views, and row by row within one. At the right and lower edge some lie outside the
// picture.
#include "shared/limits.h"
#include "shared/types.h"

#define SUPERTILE_TILES uint(SUPERTILE_SIDE * SUPERTILE_SIDE)

// An entry of a supertile's list: a splat's index, and below it a bit for each tile of the list that it touches. With
// LIST_VIEWS 2 both eyes share a list, because they mostly see the same splats. It joins a supertile of the first eye
// and one of the second, in the same row, View::lists_shift columns before it, wrapped around. The index is that of the
// first eye's splat.
#define LIST_TILES (SUPERTILE_TILES * uint(LIST_VIEWS))
#define SPLAT_OF(entry) ((entry) >> LIST_TILES)
#define TILES_OF(entry) ((entry) & (1u << LIST_TILES) - 1u)
#define TOUCHES(entry, tile) (((entry) >> (tile) & 1u) != 0u)

// A splat's tile coverage, which `project` stores for `bin`. 0: it touches no tile. IN_FEW_SUPERTILES: it is in at most
// 2 x 2 supertiles. From FEW_SHIFT on it has the list of the first of these, counted in the view. Below is a bit for
// each tile, four per supertile, row by row. IN_MANY_SUPERTILES: bin_large.comp makes its entries. This also holds for
// a splat whose lists wrap around, and for one that is in many of the other eye's, if they share lists.
#define IN_FEW_SUPERTILES 0x80000000u
#define FEW_SHIFT 16
#define FEW_END 0x8000u  // supertiles from here on count as many
#define IN_MANY_SUPERTILES 1u
#define LARGE_EACH (LARGE_VIEWS / uint(LIST_VIEWS))  // splats whose entries one work group makes

uint supertiles_across(View view) { return (view.tiles_x + uint(SUPERTILE_SIDE - 1)) / uint(SUPERTILE_SIDE); }

// The lists' column of a view's column of supertiles.
uint column_of_list(uint column, View view) {
  uint moved = column + view.lists_shift, across = supertiles_across(view);
  return moved < across ? moved : moved - across;
}

// The index of a tile in a column and row.
uint tile_number(uvec2 tile, View view) {
  uvec2 supertile = tile / uint(SUPERTILE_SIDE), within = tile % uint(SUPERTILE_SIDE);
  uint nth = view.supertile_offset + supertile.y * supertiles_across(view) + supertile.x;
  return nth * SUPERTILE_TILES + within.y * uint(SUPERTILE_SIDE) + within.x;
}

// The column and row of a tile.
uvec2 tile_of(uint tile, View view) {
  uint supertile = tile / SUPERTILE_TILES - view.supertile_offset;
  uint nth = tile % SUPERTILE_TILES;
  return uvec2(supertile % supertiles_across(view), supertile / supertiles_across(view)) * uint(SUPERTILE_SIDE) +
         uvec2(nth % uint(SUPERTILE_SIDE), nth / uint(SUPERTILE_SIDE));
}
