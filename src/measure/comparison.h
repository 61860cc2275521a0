#pragma once
// The difference of two pictures, in all numbers that `binosplat compare` prints.

#include "base/image.h"
#include "measure/flip.h"
#include "measure/metrics.h"

namespace binosplat::measure {

/// If a value is not a number, all metrics are NaN, and `largest` has its place.
struct Comparison {
  double psnr = 0.0;
  double ssim = 0.0;
  double flip = 0.0;
  Difference largest;
};

/// Whether an image has alpha other than 1.
bool is_see_through(const Image& image);

/// RGB of any image: grey as three equal channels, transparent pixels over a background.
Image composite_over(const glm::vec3& background, const Image& image);

/// Prepares two pictures for a comparison as on a screen. Clamps values to [0, 1], turns infinite ones into
/// NaN, and repeats grey if the other picture has colour. Drops alpha that is 1 everywhere. With a
/// background, or if only one picture is transparent, composites over it (default black). Else keeps alpha,
/// which then counts as a channel. Returns whether it composited transparent pixels.
bool prepare_comparison(Image& a, Image& b, const Background& background = {});

/// PSNR in dB between a picture with its exposure (exposed() of base/image.h) and a photo, both rounded to 8
/// bits.
double photo_psnr(const Image& picture, const glm::mat4x3& exposure, const Image& photo);

/// Compares two prepared pictures. Throws Error if they cannot be compared (measure/comparable.h).
Comparison compare(const Image& a, const Image& b, double pixels_per_degree = flip_pixels_per_degree);

}  // namespace binosplat::measure
