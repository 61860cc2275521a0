// Exact (FlashGS, AdR-Gaussian): a splat touches a tile if alpha reaches Th in it. That is: the smallest q over the
// rectangle of the tile's pixel centres is at most rho = 2 ln(sigma / Th). Rounding in fp32 must not drop a visible
// pair, so the test has a margin (docs/method.md 4).

bool ellipse_touches(Outline outline, float rho, vec2 low, vec2 high) {
  vec2 at;
  return lowest_level(outline, low, high, at) <= rho;
}

float lowest_level(Outline outline, View view, out vec2 at) {
  return lowest_level(outline, vec2(first_drawn(view)) - REACH, vec2(last_drawn(view)) + REACH, at);
}

// A slightly larger level, for bounds: they only limit the tiles on which the test above runs.
float ellipse_outer_rho(float rho) { return 1.001 * max(rho, 0.0) + 1e-3; }

// A slightly smaller level; the difference is much larger than the test's rounding.
float ellipse_inner_rho(float rho) { return 0.999 * rho - 1e-3; }

uvec4 tile_box(Outline outline, View view) {
  float rho = outline.level;
  if (!holds_a_centre(outline, view, level_extent(outline))) return uvec4(0u);
  vec3 c = covariance(outline);
  precise vec2 extent = sqrt(ellipse_outer_rho(rho) * c.xz) * 1.0001 + 0.01;
  uvec2 columns = tile_columns(outline.mean.x - extent.x, outline.mean.x + extent.x, view);
  uvec2 rows = tile_rows(outline.mean.y - extent.y, outline.mean.y + extent.y, view);
  // Skips a tall ellipse that lies outside the picture, without tests by row.
  vec2 at;
  if (rows.y - rows.x > TALL_ROWS && lowest_level(outline, view, at) > ellipse_outer_rho(rho)) return uvec4(0u);
  return uvec4(columns.x, rows.x, columns.y, rows.y);
}

uint likely_row(Outline outline, View view, uvec4 box) {
  if (box.w - box.y <= TALL_ROWS) return box.y;
  vec2 at;
  lowest_level(outline, view, at);
  return clamp(tile_rows(outline.mean.y + at.y, outline.mean.y + at.y, view).x, box.y, box.w - 1u);
}

uvec2 tile_row(Outline outline, View view, uvec4 box, uint row) {
  float rho = outline.level;
  precise float outer = ellipse_outer_rho(rho);
  vec3 c = covariance(outline);
  float low = tile_low(uvec2(0u, row), view).y - outline.mean.y;
  float high = tile_high(uvec2(0u, row), view).y - outline.mean.y;
  // The y of the ellipse's rightmost point is apex, of its leftmost point -apex. Then the nearest y to each in the row.
  precise float apex = c.y * sqrt(outer / c.x);
  precise float right_y = clamp(apex, low, high);
  precise float left_y = clamp(-apex, low, high);
  precise float lean = c.y / c.z;                             // slope of the line through the rows' middles
  precise float width = outline.conic.w * outline.conic.w / c.z;  // det / C2.yy: the variance within a row
  precise float left = lean * left_y - sqrt(max(0.0, (outer - left_y * left_y / c.z) * width));
  precise float right = lean * right_y + sqrt(max(0.0, (outer - right_y * right_y / c.z) * width));
  precise float slack = 0.01 + 1e-5 * (abs(left) + abs(right));
  uvec2 columns = tile_columns(outline.mean.x + left - slack, outline.mean.x + right + slack, view);
  columns = clamp(columns, box.xx, box.zz);
  // Tiles that a slightly smaller ellipse reaches pass without the test.
  precise float inner = ellipse_inner_rho(rho);
  precise vec2 heights = vec2(left_y, right_y);
  precise vec2 radicand = inner - heights * heights / c.z;
  uvec2 sure = uvec2(0u);
  if (min(radicand.x, radicand.y) > 0.0) {
    precise float first = lean * left_y - sqrt(radicand.x * width) + slack;
    precise float last = lean * right_y + sqrt(radicand.y * width) - slack;
    if (outline.mean.x + first <= float(last_drawn(view).x)) sure = tile_columns(outline.mean.x + first, outline.mean.x + last, view);
  }
  while (columns.x < columns.y && !(columns.x >= sure.x && columns.x < sure.y) &&
         !ellipse_touches(outline, rho, tile_low(uvec2(columns.x, row), view), tile_high(uvec2(columns.x, row), view))) {
    ++columns.x;
  }
  while (columns.x < columns.y && !(columns.y > sure.x && columns.y <= sure.y) &&
         !ellipse_touches(outline, rho, tile_low(uvec2(columns.y - 1u, row), view), tile_high(uvec2(columns.y - 1u, row), view))) {
    --columns.y;
  }
  return columns;
}
