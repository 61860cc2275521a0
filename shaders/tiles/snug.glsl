// The box around the ellipse where alpha reaches Th (SnugBox of Speedy-Splat) against the tile's pixel centres, touching
// counts: makes every pair that can be seen, and those of the box's corners besides.

// The tiles of a span along an axis whose pixel centres reach within `extent` of the mean: `span` is a little too large.
uvec2 snug_span(uvec2 span, int axis, Splat splat, float extent, View view) {
  float mean = splat.mean[axis];
  while (span.x < span.y && tile_high(span.xx, view)[axis] - mean < -extent) ++span.x;
  while (span.x < span.y && tile_low(uvec2(span.y - 1u), view)[axis] - mean > extent) --span.y;
  return span;
}

uvec4 tile_box(Splat splat, View view) {
  vec2 extent = level_extent(splat);
  if (!holds_a_centre(splat, view, extent)) return uvec4(0u);
  precise vec2 outer = 1.001 * extent + 0.01;
  uvec2 columns = tile_columns(splat.mean.x - outer.x, splat.mean.x + outer.x, view);
  uvec2 rows = tile_rows(splat.mean.y - outer.y, splat.mean.y + outer.y, view);
  columns = snug_span(columns, 0, splat, extent.x, view);
  rows = snug_span(rows, 1, splat, extent.y, view);
  return uvec4(columns.x, rows.x, columns.y, rows.y);
}

uint likely_row(Splat splat, View view, uvec4 box) { return box.y; }

uvec2 tile_row(Splat splat, View view, uvec4 box, uint row) { return box.xz; }
