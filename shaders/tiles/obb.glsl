// Tests GSCore's oriented box of three standard deviations against the rectangle of the tile's pixel centres, by
// separating axes. Like aabb it clips visible tails.

struct OrientedBox {
  vec2 axis;    // direction of the longer side; the other is perpendicular
  vec2 extent;  // half lengths of the longer and the other side, px
};

OrientedBox oriented_box(Outline outline) {
  vec3 c = covariance(outline);
  precise float half_difference = 0.5 * (c.x - c.z);
  precise float root = sqrt(half_difference * half_difference + c.y * c.y);
  precise float longer = 0.5 * (c.x + c.z) + root;
  precise float shorter = outline.conic.w / longer * outline.conic.w;  // the product of both is det
  OrientedBox box;
  box.extent = 3.0 * sqrt(vec2(longer, shorter));
  // The eigenvector, from the matrix row whose terms do not cancel.
  precise vec2 along = half_difference >= 0.0 ? vec2(half_difference + root, c.y) : vec2(c.y, root - half_difference);
  box.axis = root > 0.0 ? normalize(along) : vec2(1.0, 0.0);
  return box;
}

// Whether no axis separates the box from the pixel centres [low, high].
bool box_touches(Outline outline, OrientedBox box, vec2 low, vec2 high) {
  precise vec2 d = 0.5 * (low + high) - outline.mean;
  precise vec2 half_size = 0.5 * (high - low);
  precise vec2 a = abs(box.axis);
  precise vec2 reach = vec2(box.extent.x * a.x + box.extent.y * a.y, box.extent.x * a.y + box.extent.y * a.x);
  if (abs(d.x) > half_size.x + reach.x || abs(d.y) > half_size.y + reach.y) return false;
  precise float along = d.x * box.axis.x + d.y * box.axis.y;
  precise float across = d.y * box.axis.x - d.x * box.axis.y;
  precise float size_along = half_size.x * a.x + half_size.y * a.y;
  precise float size_across = half_size.x * a.y + half_size.y * a.x;
  return abs(along) <= box.extent.x + size_along && abs(across) <= box.extent.y + size_across;
}

uvec4 tile_box(Outline outline, View view) {
  if (outline.level < RHO_NONE) return uvec4(0u);
  OrientedBox box = oriented_box(outline);
  vec2 a = abs(box.axis);
  precise vec2 outer = 1.001 * vec2(box.extent.x * a.x + box.extent.y * a.y, box.extent.x * a.y + box.extent.y * a.x) + 0.01;
  uvec2 columns = tile_columns(outline.mean.x - outer.x, outline.mean.x + outer.x, view);
  uvec2 rows = tile_rows(outline.mean.y - outer.y, outline.mean.y + outer.y, view);
  return uvec4(columns.x, rows.x, columns.y, rows.y);
}

// The range of x in row y with |axis.x x + axis.y y| <= limit.
vec2 strip(vec2 axis, float y, float limit) {
  if (abs(axis.x) < 1e-6) return vec2(-3e38, 3e38);
  precise vec2 ends = (vec2(-limit, limit) - axis.y * y) / axis.x;
  return vec2(min(ends.x, ends.y), max(ends.x, ends.y));
}

uint likely_row(Outline outline, View view, uvec4 box) { return box.y; }

uvec2 tile_row(Outline outline, View view, uvec4 box, uint row) {
  OrientedBox oriented = oriented_box(outline);
  // Finds the tiles whose middles lie in the strips along both axes, slightly widened; then tests from both ends.
  float y = 0.5 * (tile_low(uvec2(0u, row), view).y + tile_high(uvec2(0u, row), view).y) - outline.mean.y;
  float tile = float(TILE_SIZE);
  vec2 a = abs(oriented.axis);
  float size = tile * (a.x + a.y);
  vec2 along = strip(oriented.axis, y, oriented.extent.x + size);
  vec2 across = strip(vec2(-oriented.axis.y, oriented.axis.x), y, oriented.extent.y + size);
  vec2 overlap = vec2(max(along.x, across.x), min(along.y, across.y));
  float slack = tile + 1e-4 * (abs(overlap.x) + abs(overlap.y));
  uvec2 columns = tile_columns(outline.mean.x + overlap.x - slack, outline.mean.x + overlap.y + slack, view);
  columns = clamp(columns, box.xx, box.zz);
  while (columns.x < columns.y &&
         !box_touches(outline, oriented, tile_low(uvec2(columns.x, row), view), tile_high(uvec2(columns.x, row), view))) {
    ++columns.x;
  }
  while (columns.x < columns.y && !box_touches(outline, oriented, tile_low(uvec2(columns.y - 1u, row), view),
                                               tile_high(uvec2(columns.y - 1u, row), view))) {
    --columns.y;
  }
  return columns;
}
