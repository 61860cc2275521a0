#pragma once
// The difference of two pictures. Both must have the same size and channels (else: Error). Alpha, if any,
// counts as a channel. To compare 8-bit pictures, quantise both first (base/image.h).

#include <span>

#include "base/image.h"

namespace binosplat::measure {

/// Peak signal-to-noise ratio in dB: -10 log10 of the mean squared error over pixels and channels, with
/// values clamped to [0, 1] but not rounded. Infinite for equal pictures; -infinity if a value is not a
/// number.
double psnr(const Image& a, const Image& b);

/// The PSNR of several pictures together, such as both eyes', over a background. Both sides have equal
/// numbers.
double psnr(std::span<const Picture> a, std::span<const Picture> b, const Background& background);

/// Structural similarity (Wang et al. 2004): Gaussian window of 11 x 11 px, sigma 1.5, K1 0.01, K2 0.03,
/// range 1, values clamped to [0, 1]. The mean over channels and all windows within the picture. 1 for equal
/// pictures; NaN if the picture is smaller than the window or has NaN.
double ssim(const Image& a, const Image& b);

/// The largest absolute error of a channel, and its place. Values are not clamped: use clamped() for those of
/// a screen. The first in row order of several equal errors; infinite if a value is not a number.
struct Difference {
  double max = 0.0;
  int x = 0;
  int y = 0;
  int channel = 0;
};
Difference largest_difference(const Image& a, const Image& b);

/// Share of the channels, 0 to 1, whose absolute error exceeds `limit`. Values are not clamped.
double share_beyond(const Image& a, const Image& b, double limit);

/// The 99.9 % quantile of absolute errors, which a few pixels cannot change. If it is 0, the largest error.
double common_error(const Image& a, const Image& b);

/// The gain for a readable difference picture: the largest power of two that keeps `error` at or below 1. 1
/// for equal pictures.
double difference_gain(double error);

/// Absolute error times `gain`, clamped to 1, in grey or RGB. Alpha's error appears in all three channels.
Image difference_picture(const Image& a, const Image& b, double gain);

/// Values clamped to [0, 1].
Image clamped(const Image& image);

}  // namespace binosplat::measure
