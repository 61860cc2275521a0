// The ellipse that decides a splat's tiles, and the smallest q(d) = d^T Q d over a rectangle.

struct Outline {
  vec2 mean;    // px
  vec2 aside;   // the rounding error of `mean`
  vec4 conic;   // Q, and sqrt(det Q^-1)
  float level;  // rho = 2 ln(sigma / Th): alpha reaches Th while q is at most this
  bool is_wide; // a wide splat: mean and conic are the splat's
};

// The vector from the ellipse's middle to a pixel's centre.
vec2 from_middle(Outline outline, vec2 pixel) {
  precise vec2 d = pixel - outline.mean - outline.aside;
  return d;
}

// Below this rho no alpha reaches the threshold. It is below 0 by more than the rounding of log2 and exp2 in fp32.
#define RHO_NONE (-4e-6)

// Returns the smallest q over the pixel centres from `low` to `high`, minus a margin for rounding. `at` is the place of
// the smallest q, relative to the mean.
float lowest_level(Outline outline, vec2 low, vec2 high, out vec2 at) {
  precise vec2 a = from_middle(outline, low);
  precise vec2 b = from_middle(outline, high);
  precise vec2 nearest = clamp(vec2(0.0), a, b);
  at = nearest;
  if (nearest == vec2(0.0)) return RHO_NONE;
  precise float xx = outline.conic.x;
  precise float xy = outline.conic.y;
  precise float yy = outline.conic.z;
  // q is convex: its smallest value lies on one of the edges that face the mean, of which there are one or two.
  precise float best = 3.4e38;
  if (nearest.x != 0.0) {
    precise float y = clamp(-xy * nearest.x / yy, a.y, b.y);
    precise float q = xx * nearest.x * nearest.x + 2.0 * xy * nearest.x * y + yy * y * y;
    best = q;
    at = vec2(nearest.x, y);
  }
  if (nearest.y != 0.0) {
    precise float x = clamp(-xy * nearest.y / xx, a.x, b.x);
    precise float q = xx * x * x + 2.0 * xy * x * nearest.y + yy * nearest.y * nearest.y;
    if (q < best) {
      best = q;
      at = vec2(x, nearest.y);
    }
  }
  precise float size = abs(xx) * at.x * at.x + 2.0 * abs(xy * at.x * at.y) + abs(yy) * at.y * at.y;
  precise float level = best - (2e-6 * size + 4e-6);
  return level;
}
