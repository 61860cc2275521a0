// With the tangent projection {q <= level} is what the picture's plane cuts out of a cone around the Gaussian's direction. Of a
// narrow splat that is an ellipse, whose shape and middle depend on the level. A wide one touches a tile where the smallest q
// over its square is at most the level, with every tile test.

#if TILES == TILES_AABB || TILES == TILES_OBB
#define OUTLINE_LEVEL(rho) 9.0  // three standard deviations
#else
#define OUTLINE_LEVEL(rho) max(rho, 0.0)
#endif

// With s the slope of the mean, b = s / focal and F = diag(1 / focal^2), |d|^2 = 1 + s^2 + 2 b.x + x^T F x at x px from the mean;
// so that q <= level is x^T (Q - level F) x - 2 level b.x <= level (1 + s^2).
Outline outline_of(Splat splat, View view) {
  const float more = 1e-5;  // what rounding may take
  if (is_wide(splat)) return Outline(splat.mean, vec2(0.0), splat.conic, splat.colour.w + more, true);
  float level = OUTLINE_LEVEL(splat.colour.w);
  precise vec2 f = 1.0 / view.lens.xy;
  precise vec2 slope = (splat.mean + 0.5 - view.lens.zw) * f;
  precise vec2 b = slope * f;
  precise vec3 m = vec3(splat.conic.x - level * f.x * f.x, splat.conic.y, splat.conic.z - level * f.y * f.y);
  precise float root = 1.0 / splat.conic.w;
  precise float det = root * root - level * (splat.conic.x * f.y * f.y + m.z * f.x * f.x);
  precise vec2 middle = level / det * vec2(m.z * b.x - m.y * b.y, m.x * b.y - m.y * b.x);
  precise float scale = 1.0 + dot(slope, slope) + dot(b, middle);
  precise vec2 mean = splat.mean + middle;
  precise vec2 aside = middle - (mean - splat.mean);
  return Outline(mean, aside, vec4(m / scale, scale * inversesqrt(det)), splat.colour.w + more, false);
}

// A wide splat: q |d|^2 is the sum of the squares of first . d and second . d; seen are rays with direction . d above 0.
struct Cone {
  vec3 first, second, direction;
  float level;
};

Cone cone_of(Outline outline, View view) {
  vec2 slope = slope_at(view, outline.mean);
  float root = sqrt(outline.conic.x);
  vec2 first = vec2(root, outline.conic.y / root) * view.lens.xy;
  float second = view.lens.y / (abs(outline.conic.w) * root);
  vec3 direction = vec3(slope, 1.0) * inversesqrt(1.0 + dot(slope, slope));
  float rounding = 3e-6 * (length(first) + second);
  return Cone(vec3(first, -dot(first, slope)), vec3(0.0, second, -second * slope.y),
              outline.conic.w < 0.0 ? -direction : direction, OUTLINE_LEVEL(outline.level) + rounding);
}

// Of rays d and e: below 0 for d = e where q is below the level.
float inside(Cone cone, vec3 d, vec3 e) {
  vec2 a = vec2(dot(cone.first, d), dot(cone.second, d)), b = vec2(dot(cone.first, e), dot(cone.second, e));
  return dot(a, b) - cone.level * dot(d, e);
}

// Whether one of the rays from d to d + along is seen, and which.
bool edge_touches(Cone cone, vec3 d, vec3 along, out vec2 at) {
  float middle = inside(cone, d, along), bend = inside(cone, along, along);
  at = d.xy;
  if (inside(cone, d, d) <= 0.0 && dot(cone.direction, d) > 0.0) return true;
  d += clamp(-middle / bend, 0.0, 1.0) * along;
  at = d.xy;
  return bend > 0.0 && inside(cone, d, d) <= 0.0 && dot(cone.direction, d) > 0.0;
}

// Whether any ray of a rectangle of slopes is seen, and which: with none on its sides, it lies outside, or around all.
bool cone_touches(Cone cone, vec2 first, vec2 last, out vec2 at) {
  vec3 axis = cone.direction;
  at = axis.xy / axis.z;
  if (axis.z > 0.0 && clamp(at, first, last) == at) return true;
  vec2 size = last - first;
  return edge_touches(cone, vec3(first, 1.0), vec3(size.x, 0.0, 0.0), at) ||
         edge_touches(cone, vec3(last.x, first.y, 1.0), vec3(0.0, size.y, 0.0), at) ||
         edge_touches(cone, vec3(last, 1.0), vec3(-size.x, 0.0, 0.0), at) ||
         edge_touches(cone, vec3(first.x, last.y, 1.0), vec3(0.0, -size.y, 0.0), at);
}

// The squares of the tiles from `first` to `last`, which leave no gaps between them, but in a probe.
bool cone_touches_tiles(Cone cone, View view, uvec2 first, uvec2 last, out vec2 at) {
  return cone_touches(cone, slope_at(view, tile_low(first, view) - 0.5), slope_at(view, tile_high(last, view) + 0.5), at);
}

// Of tiles in a row of which the `known` one is touched, those that are lie side by side: the ends of [0, count) by halves.
// `axis` is 0 for columns of one row, 1 for rows of all columns.
uvec2 touched_span(Cone cone, View view, int axis, uint row, uint known, uint count) {
  uvec2 first = axis == 0 ? uvec2(0u, row) : uvec2(0u), last = axis == 0 ? uvec2(0u, row) : uvec2(view.tiles_x - 1u, 0u);
  uvec2 low = uvec2(0u, known), high = uvec2(known, count - 1u);  // of the first that is touched, and of the last
  vec2 at;
  while (low.x < high.x) {
    uint middle = (low.x + high.x) / 2u;
    first[axis] = last[axis] = middle;
    if (cone_touches_tiles(cone, view, first, last, at)) high.x = middle;
    else low.x = middle + 1u;
  }
  while (low.y < high.y) {
    uint middle = (low.y + high.y + 1u) / 2u;
    first[axis] = last[axis] = middle;
    if (cone_touches_tiles(cone, view, first, last, at)) low.y = middle;
    else high.y = middle - 1u;
  }
  return uvec2(low.x, low.y + 1u);
}

// The tile along an axis that a slope lies in.
uint tile_at(View view, vec2 at, int axis, uint count) {
  float pixel = at[axis] * view.lens[axis] + view.lens[axis + 2] - float(tile_shift(view)[axis]);
  return uint(clamp(floor(pixel / float(tile_pitch(view))), 0.0, float(count - 1u)));
}

// Whether a wide splat touches the picture, and where.
bool touches_picture(Outline outline, View view, out vec2 at) {
  if (outline.level < RHO_NONE || view.tiles_x == 0u || view.tiles_y == 0u) return false;
  return cone_touches_tiles(cone_of(outline, view), view, uvec2(0u), uvec2(view.tiles_x, view.tiles_y) - 1u, at);
}

uvec4 box_of_tiles(Outline outline, View view) {
#if TILES != TILES_ALL
  if (outline.is_wide) {
    vec2 at;
    if (!touches_picture(outline, view, at)) return uvec4(0u);
    // A probe's tiles lie apart, so that what is seen may lie between them.
    uvec2 rows = uvec2(0u, view.tiles_y);
    if (!is_probe(view))
      rows = touched_span(cone_of(outline, view), view, 1, 0u, tile_at(view, at, 1, view.tiles_y), view.tiles_y);
    return uvec4(0u, rows.x, view.tiles_x, rows.y);
  }
#endif
  return tile_box(outline, view);
}

uvec2 row_of_tiles(Outline outline, View view, uvec4 box, uint row) {
#if TILES != TILES_ALL
  if (outline.is_wide) {
    Cone cone = cone_of(outline, view);
    vec2 at;
    if (!cone_touches_tiles(cone, view, uvec2(0u, row), uvec2(view.tiles_x - 1u, row), at)) return uvec2(0u);
    uint known = tile_at(view, at, 0, view.tiles_x);
    if (is_probe(view)) return box.xz;
    return touched_span(cone, view, 0, row, known, view.tiles_x);
  }
#endif
  return tile_row(outline, view, box, row);
}
