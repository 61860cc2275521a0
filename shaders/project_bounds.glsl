// What project_cull.comp measures for the next frame's Th: the bounds of Gaussians that this frame does not draw.
layout(std430, binding = 8) writeonly buffer NextBounds { float next_bounds[]; };  // (view, Gaussian)

// Stores a Gaussian's bound for the next frame, 1 if out of view. If Th drops the Gaussian, its bound grows slightly;
// otherwise it would never be drawn and measured again. If it is drawn, blend_measured.comp replaces the bound.
void age_bound(View view, uint gaussian, uint v, bool projected, bool drawn, Splat splat) {
  if (v >= frame.requested_views) return;  // a probe measures nothing
  bool left_out = false;
  if (THRESHOLD != THRESHOLD_EXACT && projected && !drawn) {
    splat.colour.w = visible_level(splat.opacity);
    left_out = !is_wide(splat) && touches_a_tile(splat, view);  // wide splats touch even out of view
  }
  uint at = v * frame.gaussian_count + gaussian;
  float aged = frame.has_bounds == 0u ? 1.0 : min(1.0, float(BOUND_AGEING) * bounds[at]);
  next_bounds[at] = left_out ? aged : 1.0;
}
