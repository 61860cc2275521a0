// The drawn tiles of a view: in each row of tiles a range of columns, without the columns of a hole. Other tiles get no
// pairs and stay background. One exception: a splat that reaches across the hole is also paired with the tiles in it.
#if REGIONS

layout(std430, binding = 13) readonly buffer RegionRows { uvec2 region_rows[]; };  // range, hole: columns of 16 bits

uvec2 span_of(uint columns) { return uvec2(columns & 0xFFFFu, columns >> 16); }

bool is_within(uint column, uvec2 span) { return column >= span.x && column < span.y; }

bool is_drawn(uvec2 tile, View view) {
  uvec2 row = region_rows[view.first_row + tile.y];
  return is_within(tile.x, span_of(row.x)) && !is_within(tile.x, span_of(row.y));
}

// The range from the first to the last drawn column among the columns [x, y) of tiles that a splat touches in a row.
uvec2 drawn_columns(uvec2 columns, View view, uint row) {
  uvec2 drawn = span_of(region_rows[view.first_row + row].x), hole = span_of(region_rows[view.first_row + row].y);
  uvec2 left = uvec2(max(columns.x, drawn.x), min(columns.y, drawn.y));
  if (is_within(left.x, hole)) left.x = hole.y;
  if (left.y > hole.x && left.y <= hole.y) left.y = hole.x;
  return left.x < left.y ? left : uvec2(0u);
}

#else
bool is_drawn(uvec2 tile, View view) { return true; }
uvec2 drawn_columns(uvec2 columns, View view, uint row) { return columns; }
#endif
