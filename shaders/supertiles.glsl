// Supertiles of SUPERTILE_SIDE x SUPERTILE_SIDE tiles, by which splats are binned and sorted. Tiles are numbered
// supertile by supertile over all views, and row by row in a supertile. At the right and lower edges of a picture, some
// tiles of a supertile lie outside.
#include "shared/types.h"

#define SUPERTILE_TILES uint(SUPERTILE_SIDE * SUPERTILE_SIDE)

// An entry of a supertile's list: a splat's index, and in the bits below it a bit for each tile of the list that the
// splat touches. With LIST_VIEWS 2 both eyes share lists, because they mostly see the same splats. A list then joins
// two supertiles of the same row: the first eye's, and the second eye's that is View::lists_shift columns further left,
// wrapped around. The index is that of the first eye's splat.
#define LIST_TILES (SUPERTILE_TILES * uint(LIST_VIEWS))
#define SPLAT_OF(entry) ((entry) >> LIST_TILES)
#define TILES_OF(entry) ((entry) & (1u << LIST_TILES) - 1u)
#define TOUCHES(entry, tile) (((entry) >> (tile) & 1u) != 0u)

// A splat's coverage, which `project` stores for `bin`. 0: the splat touches no tile. IN_FEW_SUPERTILES: the splat is
// in at most 2 x 2 supertiles. The bits from FEW_SHIFT on are the index of the first supertile's list in the view.
// Below are bits for the tiles, four per supertile, row by row. IN_MANY_SUPERTILES: bin_large.comp makes the splat's
// entries. This also marks wide splats, and splats whose lists wrap around. If eyes share lists and one eye's
// splat is marked, both eyes' splats are.
#define IN_FEW_SUPERTILES 0x80000000u
#define FEW_SHIFT 16
#define FEW_END 0x8000u  // lists from this index on have no IN_FEW_SUPERTILES
#define IN_MANY_SUPERTILES 1u
#define LARGE_EACH (LARGE_VIEWS / uint(LIST_VIEWS))  // splats whose entries one work group makes

uint supertiles_across(View view) { return (view.tiles_x + uint(SUPERTILE_SIDE - 1)) / uint(SUPERTILE_SIDE); }

// The column of the list to which a view's column of supertiles belongs.
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
  uint across = supertiles_across(view);
  uint y = uint((float(supertile) + 0.5) / float(across));  // exact up to 2^20; integers take longer
  return uvec2(supertile - y * across, y) * uint(SUPERTILE_SIDE) +
         uvec2(nth % uint(SUPERTILE_SIDE), nth / uint(SUPERTILE_SIDE));
}
