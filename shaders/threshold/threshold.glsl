// Th: a Gaussian is paired with the tiles in which its alpha reaches Th. The approximate blend also skips it in blocks
// in which its alpha is below Th. Otherwise the blend uses tau and the true alpha (docs/method.md 5). A rule is a file
// in this folder with one function:
//   float threshold(float size, float bound, float tolerance)   at least tau
// size: sqrt(det C2), px^2; bound: T_upper, above 0; tolerance: K or kappa.

#include "frame.glsl"

#include "threshold/transmittance_bound.glsl"
#include "threshold/{THRESHOLD_NAME}.glsl"

float threshold_of(View view, Splat splat, float bound) {
  precise float tolerance = frame.tolerance * view.tolerance_share;
  return threshold(size_of(view, splat), bound, tolerance);
}

// Th of a Gaussian in view v.
float threshold_in(View view, uint v, uint gaussian, Splat splat) {
  uint seen = v < frame.requested_views ? v : frame.probed_view;
  return threshold_of(view, splat, bound_of(view, seen, gaussian, abs(splat.depth)));
}

// The level at which alpha reaches tau: 2 ln(sigma / tau).
float visible_level(float opacity) {
  precise float rho = 1.3862943611198906 * log2(opacity / float(ALPHA_MIN));
  return rho;
}

// 2 ln(sigma / Th), the level of the tile tests; negative if no alpha reaches Th. `precise`: project_cull.comp and
// project.comp must agree.
float tile_level(View view, uint v, uint gaussian, Splat splat) {
  precise float rho = 1.3862943611198906 * log2(splat.opacity / threshold_in(view, v, gaussian, splat));
  return rho;
}
