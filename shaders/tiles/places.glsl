// The places of a view's tiles in its picture.
#include "shared/types.h"

#ifndef PROBED
#define PROBED 0  // 1: the frame has a probe
#endif
#ifndef REGIONS
#define REGIONS 0  // 1: some views have regions
#endif

#if PROBED
// There are gaps between the tiles of a probe. Its supertiles join tiles that are neighbours in the grid of its tiles.
bool is_probe(View view) { return view.is_probe != 0u; }
uint tile_pitch(View view) { return view.pitch; }
#else
bool is_probe(View view) { return false; }
uint tile_pitch(View view) { return uint(TILE_SIZE); }
#endif
#if PROBED || REGIONS
uvec2 tile_shift(View view) { return uvec2(view.shift_x, view.shift_y); }
#else
uvec2 tile_shift(View view) { return uvec2(0u); }
#endif
#if REGIONS
uvec2 first_drawn(View view) { return uvec2(view.left, view.top); }
#else
uvec2 first_drawn(View view) { return uvec2(0u); }
#endif

// The last drawn pixel of the picture; first_drawn() is the first.
uvec2 last_drawn(View view) { return first_drawn(view) + uvec2(view.width - 1u, view.height - 1u); }

// The first pixel of a tile.
uvec2 tile_corner(uvec2 tile, View view) { return tile * tile_pitch(view) + tile_shift(view); }

#include "tiles/regions.glsl"
