#pragma once
// Metrics for the difference of two pictures of the same size and channels (else: Error). Alpha counts as a
// channel. To compare 8-bit pictures, quantise both first (base/image.h).

#include <span>

#include "base/image.h"

namespace binosplat::measure {

/// The PSNR in dB that means, charts and files use for equal pictures, whose true PSNR is infinite.
constexpr double equal_db = 100.0;

/// Peak signal-to-noise ratio in dB: -10 log10 of the mean squared error over pixels and channels, with
/// values clamped to [0, 1], not rounded. Infinite for equal pictures; -infinity if a value is not a number.
double psnr(const Image& a, const Image& b);

/// The PSNR over all pixels of equally many pictures `a` and `b`, such as both eyes', over a background.
double psnr(std::span<const Picture> a, std::span<const Picture> b, const Background& background);

/// Structural similarity (Wang et al. 2004): Gaussian window of 11 x 11 px, sigma 1.5, K1 0.01, K2 0.03,
/// dynamic range 1, values clamped to [0, 1]. Returns the mean over channels and all windows within the
/// picture: 1 for equal pictures, NaN if the picture is smaller than the window or has a NaN.
double ssim(const Image& a, const Image& b);

/// The largest absolute error of a channel value, and its first place in row order. Infinite if a value is
/// NaN. Values are not clamped; for an error as on a screen, pass clamped() pictures.
struct Difference {
  double max = 0.0;
  int x = 0;
  int y = 0;
  int channel = 0;
};
Difference largest_difference(const Image& a, const Image& b);

/// The 99.9 % quantile of absolute errors, which a few outliers do not change; if it is 0, the largest error.
double common_error(const Image& a, const Image& b);

/// The gain for a difference picture: the largest power of two with gain * error <= 1; 1 for an error of 0.
double difference_gain(double error);

/// The absolute error times `gain`, at most 1, as grey or RGB. An error of alpha is in all three channels.
Image difference_picture(const Image& a, const Image& b, double gain);

/// Values clamped to [0, 1].
Image clamped(const Image& image);

}  // namespace binosplat::measure
