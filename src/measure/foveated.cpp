#include "measure/foveated.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "base/statistics.h"
#include "measure/comparable.h"
#include "shared/layout.h"

namespace binosplat::measure {

namespace {

constexpr double min_contrast_threshold = 1.0 / 64.0;  // Geisler and Perry's CT0; below: their alpha and e2
constexpr double decay = 0.106;
constexpr double half_resolution_degrees = 2.3;

// The luminance of a screen's black, relative to its white.
constexpr float black_level = 0.005f;

// Cycles per degree. Coarser structures are left in the last band.
constexpr double coarsest = 0.25;

constexpr double ring_ends[] = {0, 5, 10, 20, 30, 40, 60, 90};

// The rays of a picture, and the gaze.
struct GazeRays {
  double focal, x, y;  // px; (x, y) is the picture's middle
  glm::dvec3 gaze;

  GazeRays(const Image& picture, const Gaze& at)
      : focal(0.5 * picture.width / std::tan(0.5 * glm::radians(at.fov_degrees))),
        x(0.5 * picture.width),
        y(0.5 * picture.height),
        gaze(glm::normalize(glm::dvec3(at.x - x, at.y - y, focal))) {}

  glm::dvec3 ray(double at_x, double at_y) const { return {at_x - x, at_y - y, focal}; }
  double eccentricity(const glm::dvec3& ray) const {
    return glm::degrees(std::atan2(glm::length(glm::cross(ray, gaze)), glm::dot(ray, gaze)));
  }
  // The root of the number of pixels in a square degree around the ray.
  double pixels_per_degree(const glm::dvec3& ray) const {
    return glm::radians(1.0) * focal * std::pow(glm::length(ray) / focal, 1.5);
  }
};

Image luminance(const Image& picture) {
  Image out(picture.width, picture.height, 1);
  parallel_for(picture.height, [&](int y) {
    for (int x = 0; x < picture.width; ++x) {
      glm::vec3 colour(picture.at(x, y, 0));
      if (picture.channels >= 3) colour = {colour.r, picture.at(x, y, 1), picture.at(x, y, 2)};
      if (picture.channels == 4) colour *= picture.at(x, y, 3);
      const glm::vec3 light = shared::layout_to_linear(glm::clamp(colour, 0.0f, 1.0f));
      out.at(x, y, 0) =
          black_level + (1.0f - black_level) * glm::dot(light, glm::vec3(0.2126f, 0.7152f, 0.0722f));
    }
  });
  return out;
}

float at(const Image& image, int x, int y) {
  return image.at(std::clamp(x, 0, image.width - 1), std::clamp(y, 0, image.height - 1), 0);
}

// Halves the resolution along each axis, with the kernel 1 4 6 4 1 of Burt and Adelson.
Image reduced(const Image& image) {
  constexpr float kernel[] = {1.0f / 16, 4.0f / 16, 6.0f / 16, 4.0f / 16, 1.0f / 16};
  Image across((image.width + 1) / 2, image.height, 1), out(across.width, (image.height + 1) / 2, 1);
  parallel_for(across.height, [&](int y) {
    for (int x = 0; x < across.width; ++x) {
      for (int k = 0; k < 5; ++k) across.at(x, y, 0) += kernel[k] * at(image, 2 * x + k - 2, y);
    }
  });
  parallel_for(out.height, [&](int y) {
    for (int x = 0; x < out.width; ++x) {
      for (int k = 0; k < 5; ++k) out.at(x, y, 0) += kernel[k] * at(across, x, 2 * y + k - 2);
    }
  });
  return out;
}

// Returns a pixel of the picture with twice the resolution of `small`, interpolated with reduced()'s kernel.
float expanded(const Image& small, int x, int y) {
  const auto weights = [](int place) {
    return place % 2 == 0 ? glm::vec3(0.125f, 0.75f, 0.125f) : glm::vec3(0.0f, 0.5f, 0.5f);
  };
  const glm::vec3 across = weights(x), down = weights(y);
  float sum = 0.0f;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) sum += across[i] * down[j] * at(small, x / 2 + i - 1, y / 2 + j - 1);
  }
  return sum;
}

// Returns the share of a grating's amplitude that lies in the band of `level`, if the grating has a quarter
// of a cycle per pixel of this level. The band's filter and the finer levels' kernels reduce the amplitude: a
// kernel passes cos^4 of half the phase between neighbouring pixels.
double passed(int level) {
  double share = 1.0 - std::pow(std::cos(glm::radians(45.0)), 8.0);
  for (int k = 1; k <= level; ++k) share *= std::pow(std::cos(glm::radians(45.0) / std::exp2(k)), 4.0);
  return share;
}

void check(const Image& picture, const Gaze& gaze) {
  // The negated conditions also refuse NaN.
  if (!(gaze.fov_degrees >= 1.0 && gaze.fov_degrees <= 170.0))
    fail("a field of view of {} degrees: expected 1 to 170", gaze.fov_degrees);
  if (!(gaze.x >= 0 && gaze.x <= picture.width && gaze.y >= 0 && gaze.y <= picture.height))
    fail("gaze at ({}, {}): it lies outside the picture of {} x {} px", gaze.x, gaze.y, picture.width,
         picture.height);
}

}  // namespace

double contrast_threshold(double cycles_per_degree, double eccentricity_degrees) {
  return min_contrast_threshold *
         std::exp(decay * cycles_per_degree * (eccentricity_degrees + half_resolution_degrees) /
                  half_resolution_degrees);
}

Image times_threshold(const Image& a, const Image& b, const Gaze& gaze) {
  require_comparable(a, b);
  check(a, gaze);
  const GazeRays seen(a, gaze);
  Image out(a.width, a.height, 1);
  Image of_a = luminance(a), of_b = luminance(b);
  // Splits the pictures into octave bands, and a last band with all lower frequencies. A band has the
  // threshold of its lowest frequency, so thresholds are not overestimated.
  const auto frequency_at = [&](const glm::dvec3& ray, double pixel) {
    return 0.25 * seen.pixels_per_degree(ray) / pixel;
  };
  const glm::dvec3 straight_ahead(0.0, 0.0, seen.focal);
  for (int level = 0, side = 1; side > 0; ++level) {
    const Image mean_a = reduced(of_a), mean_b = reduced(of_b);
    const double pixel = std::exp2(level);
    const bool is_last =
        std::min(of_a.width, of_a.height) < 4 || frequency_at(straight_ahead, pixel) < coarsest;
    const double gain = is_last ? 1.0 : 1.0 / passed(level);
    Image times(of_a.width, of_a.height, 1);
    parallel_for(times.height, [&](int y) {
      for (int x = 0; x < times.width; ++x) {
        const float around_a = expanded(mean_a, x, y), around_b = expanded(mean_b, x, y);
        const float below_a = is_last ? 0.0f : around_a, below_b = is_last ? 0.0f : around_b;
        const float band = (of_a.at(x, y, 0) - below_a) - (of_b.at(x, y, 0) - below_b);
        const double contrast = gain * std::abs(band) / (0.5 * (around_a + around_b));
        const glm::dvec3 ray = seen.ray(x * pixel + 0.5, y * pixel + 0.5);
        const double frequency = is_last ? 0.0 : frequency_at(ray, pixel);
        times.at(x, y, 0) =
            static_cast<float>(contrast / contrast_threshold(frequency, seen.eccentricity(ray)));
      }
    });
    parallel_for(out.height, [&](int y) {
      for (int x = 0; x < out.width; ++x) {
        const float here = at(times, (x + side / 2) / side, (y + side / 2) / side);
        // The negated condition keeps NaN.
        if (!(out.at(x, y, 0) >= here)) out.at(x, y, 0) = here;
      }
    });
    if (is_last) break;
    of_a = mean_a;
    of_b = mean_b;
    side *= 2;
  }
  return out;
}

FoveatedComparison compare_foveated(const Image& a, const Image& b, const Gaze& gaze) {
  const Image times = times_threshold(a, b, gaze);
  const GazeRays seen(a, gaze);
  constexpr std::size_t count = std::size(ring_ends);
  std::vector<double> of_ring[count];
  double squares[count] = {};
  double visible = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const double degrees = seen.eccentricity(seen.ray(x + 0.5, y + 0.5));
      const auto ring = static_cast<std::size_t>(
          std::upper_bound(std::begin(ring_ends), std::end(ring_ends), degrees) - std::begin(ring_ends) - 1);
      of_ring[ring].push_back(times.at(x, y, 0));
      visible += times.at(x, y, 0) < 1.0f ? 0.0 : 1.0;
      for (int c = 0; c < a.channels; ++c) {
        const double d = std::clamp(a.at(x, y, c), 0.0f, 1.0f) - std::clamp(b.at(x, y, c), 0.0f, 1.0f);
        squares[ring] += d * d;
      }
    }
  }
  const double pixels = static_cast<double>(a.width) * a.height;
  FoveatedComparison found{.visible = visible / pixels};
  for (std::size_t k = 0; k < count; ++k) {
    const auto size = static_cast<double>(of_ring[k].size());
    if (of_ring[k].empty()) continue;
    const auto seen_there = std::count_if(of_ring[k].begin(), of_ring[k].end(),
                                          [](double times_there) { return !(times_there < 1.0); });
    found.rings.push_back({.from = ring_ends[k],
                           .to = k + 1 < count ? ring_ends[k + 1] : 180.0,
                           .share = size / pixels,
                           .psnr = -10.0 * std::log10(squares[k] / (size * a.channels)),
                           .visible = static_cast<double>(seen_there) / size,
                           .p99 = quantile(of_ring[k], 0.99)});
  }
  return found;
}

}  // namespace binosplat::measure
