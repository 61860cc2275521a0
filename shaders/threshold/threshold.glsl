// Th: the alpha below which a Gaussian makes no pair with a tile; the blend keeps tau and the true alpha (METHOD 5). A rule
// is a file beside this one with one function:
//   float threshold(float size, float upper, float loss)   at least tau
// size: sqrt(det C2), px^2; upper: T_upper, or W for `squared`, above 0; loss: K or kappa.

uniform uint loss_bits;  // --loss, a float's bits

#include "threshold/upper.glsl"
#include "threshold/{TH_NAME}.glsl"

// The same for what leaves a mark at all.
float visible_level(float opacity) {
  precise float rho = 1.3862943611198906 * log2(opacity / float(ALPHA_MIN));
  return rho;
}

// 2 ln(sigma / Th), the level of the tile tests; negative where no alpha reaches Th. `precise`: cull and project must agree.
float tile_level(float opacity, float size, float upper) {
  precise float rho = 1.3862943611198906 * log2(opacity / threshold(size, upper, uintBitsToFloat(loss_bits)));
  return rho;
}
