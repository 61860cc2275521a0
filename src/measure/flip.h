#pragma once
// FLIP: how visible the difference is to someone who flips between two pictures.

#include "base/image.h"

namespace binosplat::measure {

/// Pixels per degree of view where nothing else is known: a display of 0.7 m and 3840 px across, 0.7 m away.
constexpr double flip_pixels_per_degree = 67.0;

/// LDR-FLIP (Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", 2020) at each pixel,
/// one channel from 0, no difference, to 1. Both pictures are display-referred (sRGB), of one size, with
/// equal channels (else: Error); values are clamped to [0, 1]. Grey counts as colour; pictures with alpha are
/// compared over black and over white, and the larger error counts. Not a number where a value within the
/// filters' reach is none. `pixels_per_degree`, 1 to 1000 (else: Error), is what the viewer has.
Image flip_map(const Image& a, const Image& b, double pixels_per_degree = flip_pixels_per_degree);

/// Mean of the map, as the paper recommends where one number is wanted.
double flip(const Image& a, const Image& b, double pixels_per_degree = flip_pixels_per_degree);

}  // namespace binosplat::measure
