#pragma once
// FLIP: how visible the difference is when a viewer flips between two pictures.

#include "base/image.h"

namespace binosplat::measure {

/// The default pixels per degree of visual angle: a display 0.7 m and 3,840 px wide, at a distance of 0.7 m.
constexpr double flip_pixels_per_degree = 67.0;

/// LDR-FLIP (Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", 2020) of each pixel:
/// one channel from 0 (no difference) to 1. Both pictures are display-referred (sRGB), of equal size and
/// channels (else: Error); values are clamped to [0, 1]. With alpha, a pixel gets its larger error over black
/// or white. It is NaN if a NaN lies within the filters' reach. `pixels_per_degree`: 1 to 1000 (else: Error).
Image flip_map(const Image& a, const Image& b, double pixels_per_degree = flip_pixels_per_degree);

/// Mean of the map, as the paper recommends.
double flip(const Image& a, const Image& b, double pixels_per_degree = flip_pixels_per_degree);

}  // namespace binosplat::measure
