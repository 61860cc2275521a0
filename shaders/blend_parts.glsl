// Long lists in parts, for blend.comp: a dispatch blends `part_size` splats of each list, after `before_part` splats that
// other dispatches blended.
uniform uint before_part;
uniform uint part_size;
layout(std430, binding = 8) buffer Unfinished { vec4 unfinished[]; };  // by pixel, until the last part: C, T; Z, is done
bool is_first, is_last;

void keep_pixels() {
  for (uint p = 0u; p < COLUMN; ++p) {
    if (!is_inside(views[view_index], p)) continue;
    uint at = 2u * place_of(views[view_index], p);
    unfinished[at] = vec4(colour[p], transmittance_left(p));
    unfinished[at + 1u] = vec4(z_sum[p], is_done(p) ? 1.0 : 0.0, 0.0, 0.0);
  }
}

void take_pixels() {
  for (uint p = 0u; p < COLUMN; ++p) {
    if (!is_inside(views[view_index], p)) continue;
    uint at = 2u * place_of(views[view_index], p);
    colour[p] = unfinished[at].rgb;
    transmittance[p] = unfinished[at].a;
    z_sum[p] = unfinished[at + 1u].x;
    if (unfinished[at + 1u].y == 0.0) continue;
    least[p] = -transmittance[p];
    transmittance[p] = 0.0;
  }
}

// Limits the list to this dispatch's part. Returns false if another part was the last.
bool begin_part() {
  is_first = before_part == 0u;
  if (!is_first && before_part >= end - begin) return false;
  begin += before_part;
  is_last = end - begin <= part_size;
  if (!is_last) end = begin + part_size;
  if (!is_first) take_pixels();
  return true;
}
