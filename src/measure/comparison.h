#pragma once
// By how much two pictures differ, in every number that `binosplat compare` prints.

#include "base/image.h"
#include "measure/flip.h"
#include "measure/metrics.h"

namespace binosplat::measure {

/// Where a value is not a number all are undefined, NaN, and `largest` has its place.
struct Comparison {
  double psnr = 0.0;
  double ssim = 0.0;
  double flip = 0.0;
  Difference largest;
};

/// Whether an image has alpha that is not 1 everywhere.
bool is_see_through(const Image& image);

/// RGB of any image: grey as three equal channels, and what is seen through before a background.
Image before(const glm::vec3& background, const Image& image);

/// Makes two pictures what a screen shows of them: values clamped to [0, 1], infinite ones not numbers, and
/// grey as three equal channels where the other one has colour. Alpha is left out where it is 1 everywhere.
/// Where only one has other alpha, it is shown before a background, black unless that is given; with a given
/// background both are. Else alpha stays, and counts. Returns whether something that is seen through was put
/// before a background.
bool make_shown(Image& a, Image& b, const Background& background = {});

/// PSNR against a photo of what a picture becomes by its exposure (exposed() of base/image.h), both as 8 bits
/// keep them; in dB.
double photo_psnr(const Image& picture, const glm::mat4x3& exposure, const Image& photo);

/// Compares two such pictures. Throws Error where they cannot be compared (measure/comparable.h).
Comparison compare(const Image& a, const Image& b, double pixels_per_degree = flip_pixels_per_degree);

}  // namespace binosplat::measure
