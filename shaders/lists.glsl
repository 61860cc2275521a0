// The lists that pairs are sorted into: one for LIST_TILES x LIST_TILES tiles, so that splats over several tiles make fewer
// pairs. A pair's value is its splat and, where a list is of several tiles, above LIST_SPLAT_BITS a bit for each of them that
// the splat touches. Tiles are counted list by list, over all views, those of a list row by row; at the right and lower edge
// some of them lie beyond the picture.
#include "shared/limits.h"
#include "shared/types.h"

#ifndef LIST_TILES
#define LIST_TILES 1
#endif
#define LISTED (LIST_TILES * LIST_TILES)  // tiles of a list

// What `project` leaves of a splat in a view, for `pairs`: how many pairs it makes or, where these are in at most 2 x 2 lists of
// 2 x 2 tiles, IN_FEW_LISTS with the first of these lists, counted in the view, at FEW_LIST_SHIFT, and below a bit for each tile,
// four for each list, row by row; so that of a small splat `pairs` need ask nothing again.
#define IN_FEW_LISTS 0x80000000u
#define FEW_LIST_SHIFT 16
#define FEW_LISTS_END 0x8000u  // what is in a list beyond is only counted

uint count_of(uint touched) {
  if ((touched & IN_FEW_LISTS) == 0u) return touched;
  uint any = (touched | touched >> 1 | touched >> 2 | touched >> 3) & 0x1111u;
  return uint(bitCount(any));
}

uint lists_across(View view) { return (view.tiles_x + uint(LIST_TILES - 1)) / uint(LIST_TILES); }

// The column and row of a tile by its number.
uvec2 tile_of(uint tile, View view) {
  uint list = tile / LISTED - view.list_offset;
  uint nth = tile % LISTED;
  return uvec2(list % lists_across(view), list / lists_across(view)) * uint(LIST_TILES) +
         uvec2(nth % uint(LIST_TILES), nth / uint(LIST_TILES));
}
