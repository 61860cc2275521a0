// The tile of a work group, and its pixels' initial values and destinations. Included at the end of blending.glsl.

// A dispatch draws the tiles [first_tile, end_tile): those of the requested views, or of the probe.
uniform uint first_tile;
uniform uint end_tile;
// The tile that the work group draws.
uint tile = 0u;
uint begin = 0u, end = 0u;  // its list

// Finds the tile. If it returns false, the work group has nothing to draw and must end.
bool find_tile() {
  // After an overflow the frame is drawn again. Tested last, because loads before it need not wait for it.
  uint overflow = counters.overflow;
#if LISTS == LISTS_LONG
  if (overflow != 0u || group_index() >= counters.long_lists) return false;
  tile = long_lists[group_index()];
#else
  tile = first_tile + group_index();
#endif
  if (tile < first_tile || tile >= end_tile) return false;
  while (view_index + 1u < frame.view_count && tile >= views[view_index + 1u].supertile_offset * SUPERTILE_TILES) ++view_index;
  uint list = frame.list_per_view != 0u ? views[view_index].supertile_offset * SUPERTILE_TILES : tile;
  begin = ranges[2u * list];
  end = ranges[2u * list + 1u];
  bool is_own = LISTS != LISTS_SHORT || end - begin <= LONG_LIST || frame.list_per_view != 0u;
#if !PLAIN
  if (frame.has_regions != 0u && !is_drawn(tile_of(tile, views[view_index]), views[view_index])) end = begin;
#endif
  return is_own && overflow == 0u;
}

// The index of this invocation's pixel p in the frame's pixel buffers. There the tiles of a probe lie side by side.
uint place_of(View view, uint p) {
  uvec2 at = first_pixel - first_drawn(view);
  uint across = view.width;
  if (is_probe(view)) {
    uvec2 in_grid = tile_of(tile, view);
    at += in_grid * uint(TILE_SIZE) - tile_corner(in_grid, view);
    across = view.tiles_x * uint(TILE_SIZE);
  }
  return view.pixel_offset + (at.y + p) * across + at.x;
}

// The view that this tile belongs to; in a probe, the view that the probe samples.
uint view_at_hand() { return view_index < frame.requested_views ? view_index : frame.probed_view; }

bool is_inside(View view, uint p) { return first_pixel.x <= last_drawn(view).x && first_pixel.y + p <= last_drawn(view).y; }

// Initialises the pixels of this invocation. `in_tile` is the position of the first one in the tile.
void begin_pixels(uvec2 in_tile) {
  View view = views[view_index];
  uvec2 corner = tile_corner(tile_of(tile, view), view);
  middle = vec2(corner / BLEND_CELL * BLEND_CELL) + 0.5 * float(BLEND_CELL - 1u);
  first_pixel = corner + in_tile;
  column = float(first_pixel.x) - middle.x;
  begin_rays(view, vec2(corner));
  begin_block(view);
  begin_debug_view();
  for (uint p = 0u; p < COLUMN; ++p) {
    bool inside = is_inside(view, p);
    row[p] = float(first_pixel.y + p) - middle.y;
    colour[p] = vec3(0.0);
    z_sum[p] = 0.0;
    transmittance[p] = inside ? 1.0 : 0.0;
    least[p] = inside ? float(TRANSMITTANCE_MIN) : -1.0;
    begin_measuring(view, p, inside);
    begin_meshes(p, inside);
  }
}

void write_pixels() {
  View view = views[view_index];
  for (uint p = 0u; p < COLUMN; ++p) {
    if (!is_inside(view, p)) continue;
    uint to = place_of(view, p);
    float left = finished(p);
#if DEBUG_VIEW
    write_debug_view(to, left, end - begin);
#else
    write_picture(view, view_index, to, first_pixel + uvec2(0u, p) - first_drawn(view), vec4(colour[p], left));
    write_depth(to, p, left);
#endif
  }
}
