// With the affine projection a splat's level lines are ellipses.

Outline outline_of(Splat splat, View view) { return Outline(splat.mean, vec2(0.0), splat.conic, splat.colour.w, false); }

uvec4 box_of_tiles(Outline outline, View view) { return tile_box(outline, view); }

uvec2 row_of_tiles(Outline outline, View view, uvec4 box, uint row) { return tile_row(outline, view, box, row); }
