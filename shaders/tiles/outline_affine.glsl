// With the affine projection a splat is an ellipse at every level.

Outline outline_of(Splat splat, View view) { return Outline(splat.mean, vec2(0.0), splat.conic, splat.colour.w); }

uvec4 tile_box(Splat splat, View view) { return tile_box(outline_of(splat, view), view); }

uint likely_row(Splat splat, View view, uvec4 box) { return likely_row(outline_of(splat, view), view, box); }

uvec2 tile_row(Splat splat, View view, uvec4 box, uint row) { return tile_row(outline_of(splat, view), view, box, row); }
