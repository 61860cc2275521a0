// With the tangent projection {q <= level} is what the picture's plane cuts out of a cone around the Gaussian's direction. Of a
// narrow splat that is an ellipse, whose shape and middle depend on the level; of a wide one each tile is asked for its
// smallest q.

#if TILES == TILES_AABB || TILES == TILES_OBB
#define OUTLINE_LEVEL(rho) 9.0  // three standard deviations
#else
#define OUTLINE_LEVEL(rho) max(rho, 0.0)
#endif

// With s the slope of the mean, b = s / focal and F = diag(1 / focal^2), |d|^2 = 1 + s^2 + 2 b.x + x^T F x at x px from the mean;
// so that q <= level is x^T (Q - level F) x - 2 level b.x <= level (1 + s^2).
Outline outline_of(Splat splat, View view) {
  float level = OUTLINE_LEVEL(splat.colour.w);
  vec2 slope = slope_at(view, splat.mean);
  precise vec2 b = slope / view.lens.xy;
  precise vec2 f = 1.0 / (view.lens.xy * view.lens.xy);
  precise vec3 m = vec3(splat.conic.x - level * f.x, splat.conic.y, splat.conic.z - level * f.y);
  precise float root_det = 1.0 / splat.conic.w;
  precise float det = root_det * root_det - level * (splat.conic.x * f.y + splat.conic.z * f.x - level * f.x * f.y);
  precise vec2 middle = level * vec2(m.z * b.x - m.y * b.y, m.x * b.y - m.y * b.x) / det;
  precise float scale = 1.0 + dot(slope, slope) + dot(b, middle);
  precise vec2 mean = splat.mean + middle;
  precise vec2 aside = middle - (mean - splat.mean);
  return Outline(mean, aside, vec4(m / scale, scale / sqrt(det)), splat.colour.w + 1e-5);  // with what rounding may take
}

// A wide splat by its axes in the tangent plane, as long as makes q the sum of their squares over |d|^2.
struct Cone {
  vec3 first, second, direction;
  float level;
};

Cone cone_of(Splat splat, View view) {
  Cone cone;
  vec3 across, down;
  cone.direction = direction_of(splat);
  tangent_axes(cone.direction, across, down);
  float focal = sqrt(view.lens.x * view.lens.y);
  float root = sqrt(splat.conic.x);
  cone.first = focal * (root * across + splat.conic.y / root * down);
  cone.second = focal / (splat.conic.w * root) * down;
  cone.level = OUTLINE_LEVEL(splat.colour.w) + 1e-5;
  return cone;
}

// Of rays d and e: below 0 for d = e where q is below the level, but for the rounding.
float inside(Cone cone, vec3 d, vec3 e) {
  vec2 a = vec2(dot(cone.first, d), dot(cone.second, d)), b = vec2(dot(cone.first, e), dot(cone.second, e));
  return dot(a, b) - cone.level * dot(d, e);
}

bool is_seen(Cone cone, vec3 d) { return inside(cone, d, d) <= 0.0 && dot(cone.direction, d) > 0.0; }

// Whether one of the rays from d to d + along is seen.
bool edge_touches(Cone cone, vec3 d, vec3 along) {
  float middle = inside(cone, d, along), bend = inside(cone, along, along);
  return is_seen(cone, d) || (bend > 0.0 && is_seen(cone, d + clamp(-middle / bend, 0.0, 1.0) * along));
}

// Whether any ray of the rectangle of pixel centres is seen. Where none of its sides is, it lies outside, or around all of it.
bool cone_touches(Cone cone, View view, vec2 low, vec2 high) {
  vec2 first = slope_at(view, low), last = slope_at(view, high);
  vec3 axis = cone.direction;
  if (axis.z > 0.0 && clamp(axis.xy, first * axis.z, last * axis.z) == axis.xy) return true;
  vec2 size = last - first;
  return edge_touches(cone, vec3(first, 1.0), vec3(size.x, 0.0, 0.0)) ||
         edge_touches(cone, vec3(last.x, first.y, 1.0), vec3(0.0, size.y, 0.0)) ||
         edge_touches(cone, vec3(last, 1.0), vec3(-size.x, 0.0, 0.0)) ||
         edge_touches(cone, vec3(first.x, last.y, 1.0), vec3(0.0, -size.y, 0.0));
}

bool cone_touches_tiles(Cone cone, View view, uvec2 first, uvec2 last) {
  return cone_touches(cone, view, tile_low(first, view), tile_high(last, view));
}

uvec4 cone_box(Splat splat, View view) {
  if (splat.colour.w < RHO_NONE || view.tiles_x == 0u || view.tiles_y == 0u) return uvec4(0u);
  Cone cone = cone_of(splat, view);
  uvec2 right = uvec2(view.tiles_x - 1u, 0u);
  uvec2 rows = uvec2(0u, view.tiles_y);
  while (rows.x < rows.y && !cone_touches_tiles(cone, view, uvec2(0u, rows.x), uvec2(right.x, rows.x))) ++rows.x;
  while (rows.x < rows.y && !cone_touches_tiles(cone, view, uvec2(0u, rows.y - 1u), uvec2(right.x, rows.y - 1u))) --rows.y;
  return uvec4(0u, rows.x, view.tiles_x, rows.y);
}

uvec2 cone_row(Splat splat, View view, uvec4 box, uint row) {
  Cone cone = cone_of(splat, view);
  uvec2 columns = box.xz;
  while (columns.x < columns.y && !cone_touches_tiles(cone, view, uvec2(columns.x, row), uvec2(columns.x, row))) ++columns.x;
  while (columns.x < columns.y && !cone_touches_tiles(cone, view, uvec2(columns.y - 1u, row), uvec2(columns.y - 1u, row))) {
    --columns.y;
  }
  return columns;
}

uvec4 tile_box(Splat splat, View view) {
#if TILES != TILES_ALL
  if (is_wide(splat)) return cone_box(splat, view);
#endif
  return tile_box(outline_of(splat, view), view);
}

uint likely_row(Splat splat, View view, uvec4 box) {
  if (is_wide(splat)) return (box.y + box.w) / 2u;
  return likely_row(outline_of(splat, view), view, box);
}

uvec2 tile_row(Splat splat, View view, uvec4 box, uint row) {
#if TILES != TILES_ALL
  if (is_wide(splat)) return cone_row(splat, view, box, row);
#endif
  return tile_row(outline_of(splat, view), view, box, row);
}
