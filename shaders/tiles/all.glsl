// For tests of the other tile tests: every splat is paired with every tile. This takes one pair per splat and view,
// because a view's tiles share one list of all its splats (pixels.glsl).

uvec4 tile_box(Outline outline, View view) { return uvec4(0u, 0u, 1u, 1u); }

uint likely_row(Outline outline, View view, uvec4 box) { return box.y; }

uvec2 tile_row(Outline outline, View view, uvec4 box, uint row) { return box.xz; }
