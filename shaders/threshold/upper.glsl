// T_upper of a Gaussian in a view, or W with contrast: the most that its alpha counted for in a pixel of the last frame
// (METHOD 5). 1 where nothing is known: at first, after a cut, outside the view, beyond the table of depths.

#include "shared/axes.h"
#include "shared/limits.h"

#if TRANSMITTANCE == TRANSMITTANCE_ONE

float upper_of(uint gaussian, uint view, float depth) { return 1.0; }

#elif TRANSMITTANCE == TRANSMITTANCE_DEPTH

layout(std430, binding = 7) readonly buffer DepthTable { float depth_table[]; };  // T_upper of equal bins over [0, far)
uniform uint depth_bins;
uniform uint far_bits;  // world units, a float's bits

float upper_of(uint gaussian, uint view, float depth) {
  precise float bin = depth / uintBitsToFloat(far_bits) * float(depth_bins);
  return bin < float(depth_bins) ? depth_table[uint(bin)] : 1.0;
}

#else

layout(std430, binding = 7) readonly buffer Upper { float upper[]; };  // (view, Gaussian)
uniform uint gaussian_count;                                           // of the model
uniform uint remembers;                                                // 0: the last frame tells nothing of this one

// Eyes of a pair are views 2k and 2k + 1.
float upper_of(uint gaussian, uint view, float depth) {
  if (remembers == 0u) return 1.0;
  float own = upper[view * gaussian_count + gaussian];
#if TRANSMITTANCE == TRANSMITTANCE_LAST
  return own;
#else
  float other = upper[(view ^ 1u) * gaussian_count + gaussian];
  return TRANSMITTANCE == TRANSMITTANCE_BOTH ? max(own, other) : other;
#endif
}

#endif
