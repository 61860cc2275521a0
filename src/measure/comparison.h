#pragma once
// The difference of two pictures by all metrics that `binosplat compare` prints.

#include "base/image.h"
#include "measure/flip.h"
#include "measure/metrics.h"

namespace binosplat::measure {

/// If a picture has a NaN, all metrics are NaN, and `largest` has the place of the first NaN.
struct Comparison {
  double psnr = 0.0;
  double ssim = 0.0;
  double flip = 0.0;
  Difference largest;
};

/// Whether an image has a pixel whose alpha is not 1.
bool is_see_through(const Image& image);

/// Converts any image to RGB: grey becomes three equal channels, and transparent pixels are composited over
/// the background.
Image composite_over(const glm::vec3& background, const Image& image);

/// Prepares two pictures for a comparison as on a screen. Clamps values to [0, 1], turns infinite values into
/// NaN, and repeats grey in three channels if the other picture has colour. Given a background, or if only
/// one picture has an alpha channel, composites both over the background (default black). Otherwise keeps
/// alpha as a channel and premultiplies the colours by it, but drops an alpha that is 1 everywhere in both.
/// Returns whether it composited transparent pixels.
bool prepare_comparison(Image& a, Image& b, const Background& background = {});

/// PSNR in dB between a picture with this exposure (base/image.h) and a photo, both rounded to 8 bits.
double photo_psnr(const Image& picture, const glm::mat4x3& exposure, const Image& photo);

/// Compares two prepared pictures. Throws Error if they cannot be compared (measure/comparable.h).
Comparison compare(const Image& a, const Image& b, double pixels_per_degree = flip_pixels_per_degree);

}  // namespace binosplat::measure
