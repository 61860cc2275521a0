#include "measure/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "base/parallel.h"
#include "measure/comparable.h"

namespace binosplat::measure {

namespace {

constexpr int window_size = 11;  // px
constexpr int window_middle = window_size / 2;
constexpr double window_sigma = 1.5;

/// A value as a screen shows it: clamped to [0, 1]. Keeps NaN.
double shown(float value) { return std::clamp(double(value), 0.0, 1.0); }

/// |a - b|; infinite if either is NaN, so that it exceeds every limit.
double absolute_error(float a, float b) {
  if (a == b) return 0.0;  // also two infinities of the same sign
  const double error = std::abs(double(a) - double(b));
  return std::isnan(error) ? std::numeric_limits<double>::infinity() : error;
}

std::array<double, window_size> gaussian_window() {
  std::array<double, window_size> window{};
  for (int i = 0; i < window_size; ++i) {
    const double d = (i - window_middle) / window_sigma;
    window[i] = std::exp(-0.5 * d * d);
  }
  const double sum = std::accumulate(window.begin(), window.end(), 0.0);
  for (double& w : window) w /= sum;
  return window;
}

struct Moments {
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
};

double ssim_of(const Moments& m) {
  constexpr double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
  const double variance_a = m.aa - m.a * m.a, variance_b = m.bb - m.b * m.b, covariance = m.ab - m.a * m.b;
  return (2 * m.a * m.b + c1) * (2 * covariance + c2) /
         ((m.a * m.a + m.b * m.b + c1) * (variance_a + variance_b + c2));
}

/// Sums SSIM over a row of windows, whose uppermost pixel row is `y`: first each column, then along the row.
double ssim_row(const Image& a, const Image& b, int y, int channel,
                const std::array<double, window_size>& window) {
  std::vector<Moments> columns(static_cast<std::size_t>(a.width));
  for (int i = 0; i < window_size; ++i) {
    for (int x = 0; x < a.width; ++x) {
      const double va = shown(a.at(x, y + i, channel)), vb = shown(b.at(x, y + i, channel));
      Moments& m = columns[static_cast<std::size_t>(x)];
      m.a += window[i] * va;
      m.b += window[i] * vb;
      m.aa += window[i] * va * va;
      m.bb += window[i] * vb * vb;
      m.ab += window[i] * va * vb;
    }
  }
  double sum = 0.0;
  for (std::size_t x = 0; x + window_size <= columns.size(); ++x) {
    Moments m;
    for (int i = 0; i < window_size; ++i) {
      const Moments& c = columns[x + i];
      m.a += window[i] * c.a;
      m.b += window[i] * c.b;
      m.aa += window[i] * c.aa;
      m.bb += window[i] * c.bb;
      m.ab += window[i] * c.ab;
    }
    sum += ssim_of(m);
  }
  return sum;
}

double squared_error(const Image& a, const Image& b) {
  require_comparable(a, b);
  double sum = 0.0;
  for (std::size_t k = 0; k < a.data.size(); ++k) {
    const double error = shown(a.data[k]) - shown(b.data[k]);
    sum += std::isnan(error) ? std::numeric_limits<double>::infinity() : error * error;
  }
  return sum;
}

}  // namespace

double psnr(const Image& a, const Image& b) {
  return -10.0 * std::log10(squared_error(a, b) / static_cast<double>(a.data.size()));
}

double psnr(std::span<const Picture> a, std::span<const Picture> b, const Background& background) {
  if (a.size() != b.size())
    fail("cannot compare {} pictures with {}: expected equal counts", a.size(), b.size());
  double sum = 0.0, values = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    const Image image = composite(a[n], background);
    sum += squared_error(image, composite(b[n], background));
    values += static_cast<double>(image.data.size());
  }
  return -10.0 * std::log10(sum / values);
}

double ssim(const Image& a, const Image& b) {
  require_comparable(a, b);
  const int columns = a.width - window_size + 1, rows = a.height - window_size + 1;
  if (columns <= 0 || rows <= 0) return std::numeric_limits<double>::quiet_NaN();
  const std::array<double, window_size> window = gaussian_window();
  // Adds one sum per row in a fixed order, so that the result does not depend on the number of threads.
  std::vector<double> sums(static_cast<std::size_t>(rows));
  parallel_for(rows, [&](int y) {
    for (int c = 0; c < a.channels; ++c) sums[static_cast<std::size_t>(y)] += ssim_row(a, b, y, c, window);
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0) / (double(columns) * rows * a.channels);
}

Difference largest_difference(const Image& a, const Image& b) {
  require_comparable(a, b);
  Difference largest;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      for (int c = 0; c < a.channels; ++c) {
        const double error = absolute_error(a.at(x, y, c), b.at(x, y, c));
        if (error > largest.max) largest = {error, x, y, c};
      }
    }
  }
  return largest;
}

double common_error(const Image& a, const Image& b) {
  require_comparable(a, b);
  std::vector<float> errors(a.data.size());
  for (std::size_t k = 0; k < errors.size(); ++k)
    errors[k] = static_cast<float>(absolute_error(a.data[k], b.data[k]));
  const auto at =
      errors.begin() + static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(errors.size() - 1));
  std::nth_element(errors.begin(), at, errors.end());
  return *at > 0.0f ? *at : *std::max_element(at, errors.end());
}

double difference_gain(double error) {
  if (!(error > 0.0) || std::isinf(error)) return 1.0;
  return std::exp2(std::floor(-std::log2(error)));
}

Image difference_picture(const Image& a, const Image& b, double gain) {
  require_comparable(a, b);
  const bool alpha = a.channels == 4;
  Image picture(a.width, a.height, alpha ? 3 : a.channels);
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const double of_alpha = alpha ? absolute_error(a.at(x, y, 3), b.at(x, y, 3)) : 0.0;
      for (int c = 0; c < picture.channels; ++c) {
        const double error = std::max(absolute_error(a.at(x, y, c), b.at(x, y, c)), of_alpha);
        picture.at(x, y, c) = static_cast<float>(std::min(1.0, error * gain));
      }
    }
  }
  return picture;
}

Image clamped(const Image& image) {
  Image out = image;
  for (float& value : out.data) value = std::clamp(value, 0.0f, 1.0f);
  return out;
}

}  // namespace binosplat::measure
