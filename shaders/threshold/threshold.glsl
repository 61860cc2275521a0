// Th: the alpha below which a Gaussian makes no pair with a tile; the blend keeps tau and the true alpha (METHOD 5). A rule
// is a file beside this one with one function:
//   float threshold(float size, float upper, float loss)   at least tau
// size: sqrt(det C2), px^2; upper: T_upper, or W for `squared`, above 0; loss: K or kappa.
// The program declares views[] and, in gaussians.glsl, what Gaussians there are, and this file goes by them.

uniform uint loss_bits;   // --loss, a float's bits
uniform uint exact_from;  // this view and those after it are exact

#include "threshold/upper.glsl"
#include "threshold/{TH_NAME}.glsl"

float threshold_of(Splat splat, float upper) { return threshold(splat.conic.w, upper, uintBitsToFloat(loss_bits)); }

// Th of a Gaussian in view v, where it is `splat`. Eyes of a pair are views 2k and 2k + 1.
float threshold_in(uint v, uint gaussian, Gaussian g, mat3 axes, Splat splat) {
  if (v >= exact_from) return float(ALPHA_MIN);
  float own = threshold_of(splat, upper_of(gaussian, v, splat.depth));
#if TH != TH_TAU && TH_EYES == TH_EYES_SHARED_MIN
#if OFFSETS > 0
  // The other eye's own, where it has it.
  uint i = gaussian - page_first;
  if (!is_kept(i, v ^ 1u)) return own;
  g = GAUSSIAN(place_of(i, v ^ 1u));
  axes = scaled_axes(g);
#endif
  Splat other;
  if (project(views[v ^ 1u], g, axes, other))
    return min(own, threshold_of(other, upper_of(gaussian, v ^ 1u, other.depth)));
#elif TH != TH_TAU && TH_EYES == TH_EYES_CYCLOPEAN
  Splat between;
  if (project(views[views[v].th_view], g, axes, between)) {
    // The eye between was not drawn: it is taken to see what either eye sees.
    float upper = max(upper_of(gaussian, v, between.depth), upper_of(gaussian, v ^ 1u, between.depth));
    return threshold_of(between, upper);
  }
#endif
  return own;
}

// The same for what leaves a mark at all.
float visible_level(float opacity) {
  precise float rho = 1.3862943611198906 * log2(opacity / float(ALPHA_MIN));
  return rho;
}

// 2 ln(sigma / Th), the level of the tile tests; negative where no alpha reaches Th. `precise`: cull and project must agree.
float tile_level(uint v, uint gaussian, Gaussian g, mat3 axes, Splat splat) {
  precise float rho = 1.3862943611198906 * log2(splat.opacity / threshold_in(v, gaussian, g, axes, splat));
  return rho;
}
