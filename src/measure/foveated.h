#pragma once
// Compares two pictures for an eye with a fixed gaze: PSNR by distance from the gaze, and visible differences
// (docs/measuring.md).

#include <cstdint>
#include <vector>

#include "base/image.h"

namespace binosplat::measure {

/// The gaze of an eye in a pinhole picture.
struct Gaze {
  double x = 0;            // px from the picture's left edge
  double y = 0;            // px from the upper edge
  double fov_degrees = 0;  // of the picture's width, centred straight ahead
};

/// The least visible contrast of a grating of `cycles_per_degree` at `eccentricity_degrees` from the gaze:
/// Geisler and Perry, A real-time foveated multiresolution system for low-bandwidth video communication,
/// 1998. Above 1 if the grating is invisible.
double contrast_threshold(double cycles_per_degree, double eccentricity_degrees);

/// The pixels between two distances from the gaze.
struct Ring {
  double from = 0;  // degrees
  double to = 0;
  double share = 0;    // of the picture's pixels
  double psnr = 0;     // dB
  double visible = 0;  // share of the ring's pixels above the threshold
  double most = 0;     // times the threshold: 99 % of its pixels are below
};

struct FoveatedComparison {
  std::vector<Ring> rings;  // from inside out; only those with pixels
  double visible = 0;       // share of all pixels
};

/// Compares two pictures that measure::psnr() accepts. Throws Error if they cannot be compared, and for a
/// gaze outside the picture or an impossible field of view.
FoveatedComparison compare_foveated(const Image& a, const Image& b, const Gaze& gaze);

/// The difference of each pixel as a multiple of the threshold; one channel.
Image times_threshold(const Image& a, const Image& b, const Gaze& gaze);

}  // namespace binosplat::measure
