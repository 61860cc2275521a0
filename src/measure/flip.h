#pragma once
// FLIP: the visibility of the difference when a viewer flips between two pictures.

#include "base/image.h"

namespace binosplat::measure {

/// Default pixels per degree: a display of 0.7 m and 3840 px across, 0.7 m away.
constexpr double flip_pixels_per_degree = 67.0;

/// LDR-FLIP (Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", 2020) of each pixel:
/// one channel from 0 (no difference) to 1. Both pictures are display-referred (sRGB), of one size, with
/// equal channels (else: Error). Values are clamped to [0, 1]; grey is repeated in three channels. Pictures
/// with alpha are compared over black and over white, and the larger error counts. NaN if a value within the
/// filters' reach is not a number. `pixels_per_degree` is the viewer's, 1 to 1000 (else: Error).
Image flip_map(const Image& a, const Image& b, double pixels_per_degree = flip_pixels_per_degree);

/// Mean of the map, the single number that the paper recommends.
double flip(const Image& a, const Image& b, double pixels_per_degree = flip_pixels_per_degree);

}  // namespace binosplat::measure
