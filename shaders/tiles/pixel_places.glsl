// Where a frame keeps what belongs to a pixel of a view's tile. A probe's tiles are kept side by side.
uint pixel_row(View view) { return is_probe(view) ? view.tiles_x * uint(TILE_SIZE) : view.width; }

uint pixel_place(View view, uint tile, uvec2 pixel) {
  uvec2 at = pixel - first_drawn(view);
  if (is_probe(view)) {
    uvec2 in_grid = tile_of(tile, view);
    at += in_grid * uint(TILE_SIZE) - tile_corner(in_grid, view);
  }
  return view.pixel_offset + at.y * pixel_row(view) + at.x;
}
