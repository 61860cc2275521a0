#pragma once
// Compares two pictures for an eye that looks at one point, by angle from the gaze (docs/measuring.md).

#include <vector>

#include "base/image.h"

namespace binosplat::measure {

/// The gaze of an eye in a pinhole picture.
struct Gaze {
  double x = 0;            // px from the picture's left edge
  double y = 0;            // px from the upper edge
  double fov_degrees = 0;  // horizontal field of view; the view's axis meets the middle
};

/// The contrast threshold: the smallest visible contrast of a grating of `cycles_per_degree` at
/// `eccentricity_degrees` from the gaze. If it is above 1, the grating is invisible. Source: Geisler and
/// Perry, A real-time foveated multiresolution system for low-bandwidth video communication, 1998.
double contrast_threshold(double cycles_per_degree, double eccentricity_degrees);

/// The pixels between two angles from the gaze.
struct Ring {
  double from = 0;  // degrees
  double to = 0;
  double share = 0;    // of the picture's pixels
  double psnr = 0;     // dB
  double visible = 0;  // share of the ring's pixels whose difference is at least the contrast threshold
  double p99 = 0;      // 99 % quantile of the pixels' differences, as multiples of the threshold
};

struct FoveatedComparison {
  std::vector<Ring> rings;  // outwards from the gaze; only rings with pixels
  double visible = 0;       // share of all pixels whose difference is at least the threshold
};

/// Compares two pictures that measure::psnr() accepts. Throws Error for other pictures, a gaze outside the
/// picture, or an impossible field of view.
FoveatedComparison compare_foveated(const Image& a, const Image& b, const Gaze& gaze);

/// Returns the difference of each pixel as a multiple of the contrast threshold, in one channel.
Image times_threshold(const Image& a, const Image& b, const Gaze& gaze);

}  // namespace binosplat::measure
