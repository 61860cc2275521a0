// The square of 3D-GS (Kerbl 2023): half its side is three standard deviations of the longer axis, whatever the
// opacity. Its tiles follow by truncation, as by C's cast to int. As in 3D-GS, opacities below tau also count. The
// square clips visible tails: at its edge an opaque splat still has an alpha of 0.011.

uvec4 tile_box(Outline outline, View view) {
#if THRESHOLD != THRESHOLD_EXACT
  if (outline.level < RHO_NONE) return uvec4(0u);
#endif
  // INRIA's lambda, from m (half the trace) and det of the covariance, which follow from the conic.
  precise float det = outline.conic.w * outline.conic.w;
  precise float m = 0.5 * (outline.conic.x + outline.conic.z) * det;
  precise float lambda = m + sqrt(max(0.1, m * m - det));
  precise float radius = ceil(3.0 * sqrt(lambda));
  precise vec2 low = (outline.mean - radius) / float(TILE_SIZE);
  precise vec2 high = (outline.mean + radius + float(TILE_SIZE - 1)) / float(TILE_SIZE);
  // A probe has only some of these tiles.
  vec2 step = vec2(tile_pitch(view) / uint(TILE_SIZE)), shift = vec2(tile_shift(view) / uint(TILE_SIZE));
  vec2 grid = vec2(view.tiles_x, view.tiles_y);
  uvec2 first = uvec2(clamp(ceil((max(trunc(low), 0.0) - shift) / step), vec2(0.0), grid));
  uvec2 last = uvec2(clamp(ceil((max(trunc(high), 0.0) - shift) / step), vec2(0.0), grid));
  return uvec4(first, max(first, last));
}

uint likely_row(Outline outline, View view, uvec4 box) { return box.y; }

uvec2 tile_row(Outline outline, View view, uvec4 box, uint row) { return box.xz; }
