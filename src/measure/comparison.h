#pragma once
// By how much two pictures differ, in every number that `binosplat compare` prints.

#include "base/image.h"
#include "measure/flip.h"
#include "measure/metrics.h"

namespace binosplat::measure {

struct Comparison {
  double psnr = 0.0;
  double ssim = 0.0;
  double flip = 0.0;
  Difference largest;
};

/// Makes two pictures what a screen shows of them: values clamped to [0, 1], and grey as three equal channels
/// where the other one has colour.
void make_shown(Image& a, Image& b);

/// Of two such pictures. Throws Error where they cannot be compared (measure/comparable.h).
Comparison compare(const Image& a, const Image& b, double pixels_per_degree = flip_pixels_per_degree);

}  // namespace binosplat::measure
