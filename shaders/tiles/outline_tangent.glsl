// With the tangent projection {q <= level} is what the picture's plane cuts out of a cone around the Gaussian's direction. Of a
// narrow splat that is an ellipse, whose shape and middle depend on the level. Wide ones, of which there are few, are tested tile
// by tile, in the same way with every tile test.

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
  precise float scale = 1.0 + dot_precise(slope, slope) + dot_precise(b, middle);
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
  precise float root = sqrt(outline.conic.x);
  precise vec2 across = vec2(root, outline.conic.y / root) * view.lens.xy;
  precise float down = view.lens.y / (abs(outline.conic.w) * root);
  precise vec3 first = vec3(across, -dot_precise(across, slope));
  precise vec3 second = vec3(0.0, down, -down * slope.y);
  precise vec3 direction = outline.conic.w < 0.0 ? vec3(-slope, -1.0) : vec3(slope, 1.0);
  precise float level = OUTLINE_LEVEL(outline.level) + 3e-6 * (abs(across.x) + abs(across.y) + down);  // and for rounding
  return Cone(first, second, direction, level);
}

// The least and the largest of axis . d over a rectangle of slopes: its middle and half its size.
vec2 between(vec3 axis, vec2 middle, vec2 size) {
  precise float value = dot_precise(axis, vec3(middle, 1.0));
  precise float spread = dot_precise(abs(axis.xy), size);
  return vec2(value - spread, value + spread);
}

// Whether a wide splat may be seen in the squares of the tiles from `first` to `last`: each of the two squares by itself at its
// least, and |d| at its largest.
bool cone_touches(Cone cone, View view, uvec2 first, uvec2 last) {
  vec2 low = slope_at(view, tile_low(first, view) - 0.5), high = slope_at(view, tile_high(last, view) + 0.5);
  precise vec2 middle = 0.5 * (low + high);
  precise vec2 size = 0.5 * (high - low);
  vec2 across = between(cone.first, middle, size), down = between(cone.second, middle, size);
  vec2 nearest = max(vec2(0.0), max(vec2(across.x, down.x), -vec2(across.y, down.y)));
  vec2 farthest = max(abs(low), abs(high));
  precise float most = cone.level * (1.0 + dot_precise(farthest, farthest));
  return dot_precise(nearest, nearest) <= most && between(cone.direction, middle, size).y > 0.0;
}

bool touches_picture(Outline outline, View view) {
  if (outline.level < RHO_NONE || view.tiles_x == 0u || view.tiles_y == 0u) return false;
  return cone_touches(cone_of(outline, view), view, uvec2(0u), uvec2(view.tiles_x, view.tiles_y) - 1u);
}

uvec4 box_of_tiles(Outline outline, View view) {
#if TILES != TILES_ALL
  if (outline.is_wide) return outline.level < RHO_NONE ? uvec4(0u) : uvec4(0u, 0u, view.tiles_x, view.tiles_y);
#endif
  return tile_box(outline, view);
}

uvec2 row_of_tiles(Outline outline, View view, uvec4 box, uint row) {
#if TILES != TILES_ALL
  if (outline.is_wide) {
    Cone cone = cone_of(outline, view);
    uvec2 columns = box.xz;
    while (columns.x < columns.y && !cone_touches(cone, view, uvec2(columns.x, row), uvec2(columns.x, row))) ++columns.x;
    while (columns.x < columns.y && !cone_touches(cone, view, uvec2(columns.y - 1u, row), uvec2(columns.y - 1u, row)))
      --columns.y;
    return columns;
  }
#endif
  return tile_row(outline, view, box, row);
}
