// The oracle for the tests of tiles: every splat makes a pair with every tile. It is one pair a view, whose tiles share
// one list of all its splats (blend.comp).

uvec4 tile_box(Outline outline, View view) { return uvec4(0u, 0u, 1u, 1u); }

uint likely_row(Outline outline, View view, uvec4 box) { return box.y; }

uvec2 tile_row(Outline outline, View view, uvec4 box, uint row) { return box.xz; }
