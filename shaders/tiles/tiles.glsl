// The tiles of a view with which a splat makes pairs (docs/method.md 4). A tile test is a file in this folder with
// three functions:
//   uvec4 tile_box(Outline, View)                      columns [x, z) and rows [y, w) of tiles that it may touch
//   uint likely_row(Outline, View, uvec4 box)          the row of the box in which it most likely touches a tile
//   uvec2 tile_row(Outline, View, uvec4 box, uint row) columns [x, y) of the tiles that it touches in a row of the box
// `project` and `bin` call the same code and must agree to the bit, so everything that decides is `precise`.

#include "projection.glsl"
#include "supertiles.glsl"

// REACH, px: rays pass through the picture at most this far from a pixel centre along each axis. With BETWEEN rays pass
// between pixel centres, too (blend_rays.comp).
#ifndef BETWEEN
#define BETWEEN 0
#endif
#if BETWEEN
#define REACH 0.5
#else
#define REACH 0.0
#endif

#include "tiles/places.glsl"
#include "tiles/level.glsl"

// The tiles [x, y) along an axis that have pixels in [low, high], px from the begin of the first tile. Limited to the
// grid. Clamps floats, because int() of a huge float is undefined.
uvec2 tile_span(float low, float high, uint pitch, uint tiles) {
  float first = clamp(ceil((low - float(TILE_SIZE - 1) - REACH) / float(pitch)), 0.0, float(tiles));
  float last = clamp(floor((high + REACH) / float(pitch)), -1.0, float(tiles) - 1.0);
  return uvec2(uint(first), max(uint(first), uint(last + 1.0)));
}

uvec2 tile_columns(float low, float high, View view) {
  uvec2 shift = tile_shift(view);
  return tile_span(low - float(shift.x), high - float(shift.x), tile_pitch(view), view.tiles_x);
}

uvec2 tile_rows(float low, float high, View view) {
  uvec2 shift = tile_shift(view);
  return tile_span(low - float(shift.y), high - float(shift.y), tile_pitch(view), view.tiles_y);
}

// The first and the last pixel centre of a tile, widened by REACH; the last one is clipped to the picture.
vec2 tile_low(uvec2 tile, View view) { return vec2(tile_corner(tile, view)) - REACH; }

vec2 tile_high(uvec2 tile, View view) {
  return vec2(min(tile_corner(tile, view) + uint(TILE_SIZE - 1), last_drawn(view))) + REACH;
}

// C2 from the conic as xx, xy, yy, multiplied in an order that does not overflow.
vec3 covariance(Outline outline) {
  precise float s = outline.conic.w;
  precise vec3 c = vec3(outline.conic.z * s * s, -outline.conic.y * s * s, outline.conic.x * s * s);
  return c;
}

// Half the size of the box around {alpha >= Th}, px. Enlarges rho: fp32 rounding must drop no pair (docs/method.md 4).
vec2 level_extent(Outline outline) {
  vec3 c = covariance(outline);
  // C2.xx C2.yy / det, at least 1: the factor by which a long leaning ellipse magnifies rounding.
  precise float stretch = c.x * outline.conic.x;
  precise float rho = max(0.0, outline.level) * (1.0 + 8e-6 * stretch) + 4e-6;
  precise vec2 extent = sqrt(rho * c.xz);
  return extent;
}

// Whether the box of half size `extent` around the mean has a drawn pixel's centre. If not, the splat is invisible.
bool holds_a_centre(Outline outline, View view, vec2 extent) {
  if (outline.level < RHO_NONE) return false;
  vec2 first = vec2(first_drawn(view)) - REACH, last = vec2(last_drawn(view)) + REACH;
#if BETWEEN
  precise vec2 nearest = clamp(outline.mean, first, last);
#else
  precise vec2 nearest = clamp(round(outline.mean), first, last);
#endif
  precise vec2 d = abs(from_middle(outline, nearest));
  return d.x <= extent.x && d.y <= extent.y;
}

#include "tiles/{TILES_NAME}.glsl"
#include "tiles/outline_{PROJECTION_NAME}.glsl"

// The drawn columns among those that a splat touches in a row. TILES_ALL keeps all columns: its tiles share one list.
uvec2 paired_columns(uvec2 columns, View view, uint row) {
#if TILES == TILES_ALL
  return columns;
#else
  return drawn_columns(columns, view, row);
#endif
}

// The rows [x, y) of supertiles that a box of tiles intersects.
uvec2 supertile_rows(uvec4 box) {
  return box.w <= box.y ? uvec2(0u) : uvec2(box.y / uint(SUPERTILE_SIDE), (box.w - 1u) / uint(SUPERTILE_SIDE) + 1u);
}

// A splat in a row of supertiles. `columns`: it is in the supertiles [x, y). `tiles`: it touches the tiles [x, y) in
// the first row of tiles, and the tiles [z, w) in the second.
struct SupertileRow {
  uvec2 columns;
  uvec4 tiles;
};

SupertileRow supertile_row_of(uvec4 tiles) {
  uvec2 upper = tiles.x < tiles.y ? uvec2(tiles.x / 2u, (tiles.y + 1u) / 2u) : uvec2(0xFFFFFFFFu, 0u);
  uvec2 lower = tiles.z < tiles.w ? uvec2(tiles.z / 2u, (tiles.w + 1u) / 2u) : uvec2(0xFFFFFFFFu, 0u);
  uvec2 both = uvec2(min(upper.x, lower.x), max(upper.y, lower.y));
  return SupertileRow(both.y == 0u ? uvec2(0u) : both, tiles);
}

SupertileRow supertile_row(Outline outline, View view, uvec4 box, uint nth) {
  uvec4 tiles = uvec4(0u);
  uint row = nth * uint(SUPERTILE_SIDE);
  if (row >= box.y) tiles.xy = paired_columns(row_of_tiles(outline, view, box, row), view, row);
  if (row + 1u < box.w) tiles.zw = paired_columns(row_of_tiles(outline, view, box, row + 1u), view, row + 1u);
  return supertile_row_of(tiles);
}

// The tiles that a splat touches in a column of supertiles of this row, one bit each.
uint tiles_in(SupertileRow row, uint column) {
  uvec2 tiles = uvec2(2u * column, 2u * column + 1u);
  uvec2 upper = uvec2(greaterThanEqual(tiles, row.tiles.xx)) * uvec2(lessThan(tiles, row.tiles.yy));
  uvec2 lower = uvec2(greaterThanEqual(tiles, row.tiles.zz)) * uvec2(lessThan(tiles, row.tiles.ww));
  return upper.x | upper.y << 1 | lower.x << 2 | lower.y << 3;
}

// A splat's coverage (supertiles.glsl). Loops over rows of tiles, so that neighbouring invocations test together.
uint coverage_of(Outline outline, View view) {
  uvec4 box = box_of_tiles(outline, view);
  uvec2 rows = supertile_rows(box);
  uint across = supertiles_across(view), columns = (box.z + 1u) / 2u - box.x / 2u;
  uint column = column_of_list(box.x / 2u, view), supertile = rows.x * across + column;
  bool are_few = rows.y - rows.x <= 2u && columns <= 2u && column + columns <= across && supertile < FEW_END;
  if (outline.is_wide || !are_few) return IN_MANY_SUPERTILES;
  uint bits = 0u;
  for (uint row = box.y; row < box.w; ++row) {
    uvec2 columns = paired_columns(tile_row(outline, view, box, row), view, row);
    uvec2 from = columns - (box.x & ~1u);
    uint row_bits = columns.x < columns.y ? (1u << from.y) - (1u << from.x) : 0u;
    bits |= (row_bits & 3u | (row_bits & 12u) << 2) << (8u * (row / 2u - rows.x) + 2u * (row % 2u));
  }
  return bits == 0u ? 0u : IN_FEW_SUPERTILES | supertile << FEW_SHIFT | bits;
}

// Whether a splat touches any tile. Returns true for all wide splats that may be visible: tests of these few splats
// would delay neighbouring invocations.
bool touches_a_tile(Splat splat, View view) {
#if TILES == TILES_ELLIPSE
  // Most splats reach Th at the pixel centre nearest to their mean, and need no further test. A probe's tiles may not
  // contain this pixel. (With the tangent projection q is smaller by |d|^2, which is at least 1.)
  vec2 nearest = clamp(round(splat.mean), vec2(first_drawn(view)), vec2(last_drawn(view)));
  vec2 d = nearest - splat.mean;
  float q = splat.conic.x * d.x * d.x + 2.0 * splat.conic.y * d.x * d.y + splat.conic.z * d.y * d.y;
  if (!is_wide(splat) && !is_probe(view) && q <= ellipse_inner_rho(splat.colour.w)) {
    uvec2 tile = (uvec2(nearest) - tile_shift(view)) / uint(TILE_SIZE);
    if (is_drawn(tile, view)) return true;
  }
#endif
  Outline outline = outline_of(splat, view);
  if (outline.is_wide) return outline.level >= RHO_NONE;
  uvec4 box = tile_box(outline, view);
  uint likely = likely_row(outline, view, box);
  for (uint n = 0u; n < box.w - box.y; ++n) {
    uint row = n == 0u ? likely : box.y + n - uint(box.y + n <= likely);
    uvec2 columns = paired_columns(tile_row(outline, view, box, row), view, row);
    if (columns.y > columns.x) return true;
  }
  return false;
}
