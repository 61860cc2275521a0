// With the tangent projection the region {q <= level} is the intersection of the picture's plane with a cone around the
// Gaussian's direction. For splats that are not wide it is an ellipse, whose shape and middle depend on the level.
// Wide splats are few: whatever the tile test and the threshold, they are paired with all tiles in which they may be
// visible, and some more (docs/method.md 4).

#if TILES == TILES_AABB || TILES == TILES_OBB
#define OUTLINE_LEVEL(rho) 9.0  // three standard deviations
#else
#define OUTLINE_LEVEL(rho) max(rho, 0.0)
#endif

// With s the slope of the mean, b = s / focal and F = diag(1 / focal^2), |d|^2 = 1 + s^2 + 2 b.x + x^T F x at x px from
// the mean. So q <= level becomes x^T (Q - level F) x - 2 level b.x <= level (1 + s^2).
Outline outline_of(Splat splat, View view) {
  const float more = 1e-5;  // a margin for rounding
  if (is_wide(splat)) {
    precise float seen = splat.colour.w < RHO_NONE ? -1.0 : 1.3862943611198906 * log2(splat.opacity / float(ALPHA_MIN));
    precise float level = seen + more;
    return Outline(splat.mean, vec2(0.0), splat.conic, level, true);
  }
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
  precise vec4 conic = vec4(m / scale, scale * inversesqrt(det));
  precise float reached = splat.colour.w + more;
  return Outline(mean, aside, conic, reached, false);
}

// A wide splat: q |d|^2 is the sum of the squares of first . d and second . d. It is visible only to rays with
// direction . d > 0.
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
  precise float level = max(outline.level, 0.0) + 3e-6 * (abs(across.x) + abs(across.y) + down);  // plus rounding
  return Cone(first, second, direction, level);
}

// The range of horizontal slopes, slightly widened, in which a wide splat may be visible in the rows of pixels [first,
// last]; first > second if empty. The range depends on the largest |d| within it, so it is computed three times.
vec2 seen_across(Cone cone, View view, float first, float last) {
  vec2 low = slope_at(view, vec2(float(first_drawn(view).x) - 0.5, first - 0.5));
  vec2 high = slope_at(view, vec2(float(last_drawn(view).x) + 0.5, last + 0.5));
  precise float y = 0.5 * (low.y + high.y);
  precise float size = 0.5 * (high.y - low.y);
  precise float down = max(0.0, abs(cone.second.y * y + cone.second.z) - cone.second.y * size);
  precise float middle = -(cone.first.y * y + cone.first.z) / cone.first.x;
  precise float spread = abs(cone.first.y) * size;
  vec2 seen = vec2(low.x, high.x);
  for (int n = 0; n < 3; ++n) {
    precise float square = 1.0 + max(seen.x * seen.x, seen.y * seen.y) + max(low.y * low.y, high.y * high.y);
    precise float radicand = cone.level * square - down * down;
    precise float reach = (sqrt(max(radicand, 0.0)) + spread) / cone.first.x;
    seen = vec2(max(seen.x, middle - reach), min(seen.y, middle + reach));
    if (radicand < 0.0 || seen.x > seen.y) return vec2(1.0, 0.0);
  }
  // The splat is invisible behind the eye.
  precise float ahead = cone.direction.y * y + abs(cone.direction.y) * size + cone.direction.z;
  precise float end = -ahead / cone.direction.x;
  if (cone.direction.x > 0.0) seen.x = max(seen.x, end);
  if (cone.direction.x < 0.0) seen.y = min(seen.y, end);
  return cone.direction.x == 0.0 && ahead <= 0.0 ? vec2(1.0, 0.0) : seen;
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
    vec2 rows = vec2(tile_low(uvec2(0u, row), view).y, tile_high(uvec2(0u, row), view).y);
    vec2 seen = seen_across(cone_of(outline, view), view, rows.x, rows.y);
    if (seen.x > seen.y) return uvec2(0u);
    precise vec2 columns = seen * view.lens.x + (view.lens.z - 0.5);
    return tile_columns(columns.x - 1.0, columns.y + 1.0, view);
  }
#endif
  return tile_row(outline, view, box, row);
}
