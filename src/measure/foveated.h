#pragma once
// How far two pictures are apart for an eye that looks at one place of them: PSNR by distance from there, and
// where a difference can be seen at all (docs/measuring.md).

#include <cstdint>
#include <vector>

#include "base/image.h"

namespace binosplat::measure {

/// Where an eye looks in a pinhole's picture.
struct Gaze {
  double x = 0;            // px from the picture's left edge,
  double y = 0;            // and from its upper one
  double fov_degrees = 0;  // that the picture's width takes, its middle straight ahead
};

/// The contrast that a grating of `cycles_per_degree` needs to be seen `eccentricity_degrees` from where the
/// eye looks: Geisler and Perry, A real-time foveated multiresolution system for low-bandwidth video
/// communication, 1998. Above 1 where none is seen.
double contrast_threshold(double cycles_per_degree, double eccentricity_degrees);

/// The pixels between two distances from where the eye looks.
struct Ring {
  double from = 0;  // degrees
  double to = 0;
  double share = 0;    // of the picture's pixels
  double psnr = 0;     // dB
  double visible = 0;  // share of the ring's pixels whose difference reaches the threshold
  double most = 0;     // times the threshold that 99 of 100 of its pixels stay below
};

struct FoveatedComparison {
  std::vector<Ring> rings;  // from the inside out; only those that have pixels
  double visible = 0;       // of all pixels
};

/// Compares two such pictures as measure::psnr() takes. Throws Error where they cannot be compared, and for a
/// gaze outside the picture or a field of view that no pinhole has.
FoveatedComparison compare_foveated(const Image& a, const Image& b, const Gaze& gaze);

/// By pixel, how many times the threshold the difference reaches, one channel.
Image times_threshold(const Image& a, const Image& b, const Gaze& gaze);

}  // namespace binosplat::measure
