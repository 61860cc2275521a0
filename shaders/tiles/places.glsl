// Where the tiles of a view lie in its picture.
#include "shared/types.h"

#ifndef PROBED
#define PROBED 0  // 1: the frame has a probe
#endif

#if PROBED
// The tiles of a probe lie apart: its supertiles are of tiles that are neighbours among these.
bool is_probe(View view) { return view.is_probe != 0u; }
uint tile_pitch(View view) { return view.pitch; }
uvec2 tile_shift(View view) { return uvec2(view.shift_x, view.shift_y); }
#else
bool is_probe(View view) { return false; }
uint tile_pitch(View view) { return uint(TILE_SIZE); }
uvec2 tile_shift(View view) { return uvec2(0u); }
#endif

// The first pixel of a tile.
uvec2 tile_corner(uvec2 tile, View view) { return tile * tile_pitch(view) + tile_shift(view); }
