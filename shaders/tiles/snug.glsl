// The box around the ellipse where alpha reaches Th (SnugBox of Speedy-Splat) against the tile's pixel centres, touching
// counts: makes every pair that can be seen, and those of the box's corners besides.

// The tiles of a span whose pixel centres reach within `extent` of the mean: `span` is a little too large.
uvec2 snug_span(uvec2 span, float mean, float extent, uint pixels) {
  while (span.x < span.y && float(min(span.x * uint(TILE_SIZE) + uint(TILE_SIZE - 1), pixels - 1u)) - mean < -extent) ++span.x;
  while (span.x < span.y && float((span.y - 1u) * uint(TILE_SIZE)) - mean > extent) --span.y;
  return span;
}

uvec4 tile_box(Splat splat, View view) {
  vec2 extent = level_extent(splat);
  if (!holds_a_centre(splat, view, extent)) return uvec4(0u);
  precise vec2 outer = 1.001 * extent + 0.01;
  uvec2 columns = tile_span(splat.mean.x - outer.x, splat.mean.x + outer.x, view.tiles_x);
  uvec2 rows = tile_span(splat.mean.y - outer.y, splat.mean.y + outer.y, view.tiles_y);
  columns = snug_span(columns, splat.mean.x, extent.x, view.width);
  rows = snug_span(rows, splat.mean.y, extent.y, view.height);
  return uvec4(columns.x, rows.x, columns.y, rows.y);
}

uint likely_row(Splat splat, View view, uvec4 box) { return box.y; }

uvec2 tile_row(Splat splat, View view, uvec4 box, uint row) { return box.xz; }
