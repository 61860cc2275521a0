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

// Of rays d and e: below 0 for d = e where q is below the level.
float inside(Cone cone, vec3 d, vec3 e) {
  precise float level = dot_precise(cone.first, d) * dot_precise(cone.first, e) +
                        dot_precise(cone.second, d) * dot_precise(cone.second, e) - cone.level * dot_precise(d, e);
  return level;
}

bool is_ahead(Cone cone, vec3 d) { return dot_precise(cone.direction, d) > 0.0; }

// Slopes that are seen, as far as they are known: of the lowest x to the highest. None at first.
#define NO_SLOPES vec2(1e30, -1e30)

void take(inout vec2 seen, float x) { seen = vec2(min(seen.x, x), max(seen.y, x)); }

// Takes the ends of what is seen of the rays from d to d + along.
void take_edge(Cone cone, vec3 d, vec3 along, inout vec2 seen) {
  precise vec3 last = d + along;
  float start = inside(cone, d, d), middle = inside(cone, d, along), bend = inside(cone, along, along);
  if (start <= 0.0 && is_ahead(cone, d)) take(seen, d.x);
  if (inside(cone, last, last) <= 0.0 && is_ahead(cone, last)) take(seen, last.x);
  precise float square = middle * middle - bend * start;
  if (bend <= 0.0 || square < 0.0) return;
  precise float root = sqrt(square);
  precise vec2 ends = vec2(-middle - root, root - middle) / bend;
  precise vec3 deepest = d - middle / bend * along;
  if (ends.y < 0.0 || ends.x > 1.0 || !is_ahead(cone, deepest)) return;
  precise vec2 x = d.x + clamp(ends, 0.0, 1.0) * along.x;
  take(seen, x.x);
  take(seen, x.y);
}

// What is seen of a rectangle of slopes. Where none of its sides is, it lies outside, or around all.
vec2 seen_in(Cone cone, vec2 first, vec2 last) {
  vec2 seen = NO_SLOPES;
  precise vec2 size = last - first;
  precise vec2 axis = cone.direction.xy / cone.direction.z;
  if (cone.direction.z > 0.0 && clamp(axis, first, last) == axis) take(seen, axis.x);
  take_edge(cone, vec3(first, 1.0), vec3(size.x, 0.0, 0.0), seen);
  take_edge(cone, vec3(first.x, last.y, 1.0), vec3(size.x, 0.0, 0.0), seen);
  take_edge(cone, vec3(first, 1.0), vec3(0.0, size.y, 0.0), seen);
  take_edge(cone, vec3(last.x, first.y, 1.0), vec3(0.0, size.y, 0.0), seen);
  return seen;
}

// The squares of the tiles from `first` to `last`, which leave no gaps between them, but in a probe.
vec2 seen_in_tiles(Cone cone, View view, uvec2 first, uvec2 last) {
  return seen_in(cone, slope_at(view, tile_low(first, view) - 0.5), slope_at(view, tile_high(last, view) + 0.5));
}

bool touches(Cone cone, View view, uint column, uint row) {
  vec2 seen = seen_in_tiles(cone, view, uvec2(column, row), uvec2(column, row));
  return seen.x <= seen.y;
}

uint column_at(View view, float slope) {
  precise float pixel = slope * view.lens.x + view.lens.z - float(tile_shift(view).x);
  return uint(clamp(floor(pixel / float(tile_pitch(view))), 0.0, float(view.tiles_x - 1u)));
}

bool touches_picture(Outline outline, View view) {
  if (outline.level < RHO_NONE || view.tiles_x == 0u || view.tiles_y == 0u) return false;
  vec2 seen = seen_in_tiles(cone_of(outline, view), view, uvec2(0u), uvec2(view.tiles_x, view.tiles_y) - 1u);
  return seen.x <= seen.y;
}

// How many columns beyond a touched one, of `count` in direction `by`, are touched, too: by steps that grow until one is not.
uint touched_beyond(Cone cone, View view, uint row, uint column, int by, uint count) {
  uint known = 0u, step = 1u;
  bool grows = true;
  while (step > 0u && known < count) {
    uint next = min(known + step, count);
    bool is_touched = touches(cone, view, uint(int(column) + by * int(next)), row);
    if (is_touched) known = next;
    grows = grows && is_touched;
    step = grows ? 2u * step : step / 2u;
  }
  return known;
}

// The columns that a wide splat touches in a row. They lie side by side: those of what the row's sides see, and some beyond.
uvec2 cone_row(Outline outline, View view, uint row) {
  Cone cone = cone_of(outline, view);
  vec2 seen = seen_in_tiles(cone, view, uvec2(0u, row), uvec2(view.tiles_x - 1u, row));
  if (seen.x > seen.y) return uvec2(0u);
  if (is_probe(view)) return uvec2(0u, view.tiles_x);  // whose tiles lie apart
  uint first = column_at(view, seen.x), last = column_at(view, seen.y);
  first -= touched_beyond(cone, view, row, first, -1, first);
  last += touched_beyond(cone, view, row, last, 1, view.tiles_x - 1u - last);
  return uvec2(first, last + 1u);
}

uvec4 box_of_tiles(Outline outline, View view) {
#if TILES != TILES_ALL
  if (outline.is_wide) return outline.level < RHO_NONE ? uvec4(0u) : uvec4(0u, 0u, view.tiles_x, view.tiles_y);
#endif
  return tile_box(outline, view);
}

uvec2 row_of_tiles(Outline outline, View view, uvec4 box, uint row) {
#if TILES != TILES_ALL
  if (outline.is_wide) return cone_row(outline, view, row);
#endif
  return tile_row(outline, view, box, row);
}
