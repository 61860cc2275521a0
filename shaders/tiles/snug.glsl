// Tests the upright box around the ellipse in which alpha reaches Th (SnugBox of Speedy-Splat) against the rectangle of
// the tile's pixel centres. It makes every visible pair, and also invisible pairs in the corners of the box.

// Removes tiles from both ends of `span`, which is slightly too large, until both end tiles have a pixel centre within
// `extent` of the mean along the axis.
uvec2 snug_span(uvec2 span, int axis, Outline outline, float extent, View view) {
  while (span.x < span.y && from_middle(outline, tile_high(span.xx, view))[axis] < -extent) ++span.x;
  while (span.x < span.y && from_middle(outline, tile_low(uvec2(span.y - 1u), view))[axis] > extent) --span.y;
  return span;
}

uvec4 tile_box(Outline outline, View view) {
  vec2 extent = level_extent(outline);
  if (!holds_a_centre(outline, view, extent)) return uvec4(0u);
  precise vec2 outer = 1.001 * extent + 0.01;
  uvec2 columns = tile_columns(outline.mean.x - outer.x, outline.mean.x + outer.x, view);
  uvec2 rows = tile_rows(outline.mean.y - outer.y, outline.mean.y + outer.y, view);
  columns = snug_span(columns, 0, outline, extent.x, view);
  rows = snug_span(rows, 1, outline, extent.y, view);
  return uvec4(columns.x, rows.x, columns.y, rows.y);
}

uint likely_row(Outline outline, View view, uvec4 box) { return box.y; }

uvec2 tile_row(Outline outline, View view, uvec4 box, uint row) { return box.xz; }
