#pragma once
// How far two pictures are apart. Both have the same size and channels (else: Error); alpha, where there is
// one, counts as a channel like the others. Pictures of 8 bits are compared by quantising both first
// (base/image.h).

#include <span>

#include "base/image.h"

namespace binosplat::measure {

/// Peak signal-to-noise ratio in dB: -10 log10 of the mean squared error over pixels and channels, of values
/// clamped to [0, 1] and not rounded. Infinite for equal pictures; -infinity if a value is not a number.
double psnr(const Image& a, const Image& b);

/// The same of several pictures over a background, such as both eyes', taken together; as many on both sides.
double psnr(std::span<const Picture> a, std::span<const Picture> b, const Background& background);

/// Structural similarity (Wang et al. 2004): Gaussian window of 11 x 11 px, sigma 1.5, K1 0.01, K2 0.03,
/// range 1, of values clamped to [0, 1]; the mean over channels and the positions where the window lies
/// within the picture. 1 for equal pictures; not a number for pictures smaller than the window, or with a
/// value that is none.
double ssim(const Image& a, const Image& b);

/// The largest absolute error of a channel, and where. Values are taken as they are, not clamped: use
/// clamped() for what a screen shows. The first in row order where several are as large; infinite if a value
/// is not a number.
struct Difference {
  double max = 0.0;
  int x = 0;
  int y = 0;
  int channel = 0;
};
Difference largest_difference(const Image& a, const Image& b);

/// Share of the channels, 0 to 1, whose absolute error exceeds `limit`; values as they are.
double share_beyond(const Image& a, const Image& b, double limit);

/// The absolute error that all but one in a thousand of the values keep below, whatever a few pixels do; the
/// largest where fewer than that differ at all.
double common_error(const Image& a, const Image& b);

/// The gain that makes a difference picture readable: the largest power of two that keeps `error` at or below
/// 1, and 1 for equal pictures.
double difference_gain(double error);

/// Absolute error times `gain`, clamped to 1: grey or RGB. An error of alpha is shown in all three channels.
Image difference_picture(const Image& a, const Image& b, double gain);

/// Values clamped to [0, 1].
Image clamped(const Image& image);

}  // namespace binosplat::measure
