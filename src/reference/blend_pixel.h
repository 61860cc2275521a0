#pragma once
// Blends one pixel exactly as docs/method.md 3 defines it. Only for files in src/reference.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "reference/blend.h"
#include "reference/tiles.h"
#include "shared/limits.h"

namespace binosplat::reference {

/// The sums of a pixel so far.
struct PixelSum {
  glm::dvec3 colour{0.0};                                     // C
  double z_sum = 0.0;                                         // Z
  double transmittance = 1.0;                                 // T
  double farthest = std::numeric_limits<double>::infinity();  // view z beyond which splats are hidden
};

enum class Verdict { skipped, blended, stopped };

/// The alpha of a splat at pixel (x, y), before the comparison with tau. 0 if q is negative, or above 2 ln
/// 255 = 11.08: even an opacity of 1 then gives less than tau.
inline double alpha_at(const Splat& splat, int x, int y) {
  const double q = squared_distance(splat, {x, y});
  if (q < 0.0 || q > 11.1) return 0.0;
  return std::min(ALPHA_MAX, splat.opacity * std::exp(-0.5 * q));
}

/// The view z of a splat along the ray of pixel (x, y), with a flat Gaussian's depth at its mean.
inline double depth_at(const Splat& splat, int x, int y) {
  const glm::dvec3 p(x, y, 1);
  return splat.cone ? splat.depth / std::sqrt(glm::dot(p, splat.cone->ray * p)) : splat.depth;
}

/// The view z that a splat adds to Z: a flat Gaussian's is where the ray meets its plane.
inline double z_at(const Splat& splat, int x, int y) {
  if (!splat.plane) return depth_at(splat, x, y);
  const double inverse = glm::dot(*splat.plane, glm::dvec3(x, y, 1));
  const double mean = 1.0 / glm::dot(*splat.plane, glm::dvec3(splat.mean, 1));
  return std::clamp(inverse > 0.0 ? 1.0 / inverse : INFINITY, mean - splat.reach, mean + splat.reach);
}

/// Blends one splat at depth z behind the previous ones.
inline void add(PixelSum& sum, const Splat& splat, double z, double alpha) {
  sum.colour += alpha * sum.transmittance * splat.colour;
  sum.z_sum += alpha * sum.transmittance * z;
  sum.transmittance *= 1 - alpha;
}

/// Blends a list at a pixel, behind the splats in `sum`. Returns whether the pixel ended. Calls visit(index,
/// alpha, sum, verdict) for each Gaussian, with the sum before it.
template <typename Visit>
bool blend_on(PixelSum& sum, const std::vector<Splat>& splats, std::span<const std::uint32_t> list,
              const glm::ivec2& pixel, Faults faults, const Visit& visit) {
  for (const std::uint32_t i : list) {
    const Splat& splat = splats[i];
    const double alpha = alpha_at(splat, pixel.x, pixel.y);
    if (alpha < ALPHA_MIN || depth_at(splat, pixel.x, pixel.y) > sum.farthest) {
      visit(i, alpha, sum, Verdict::skipped);
      continue;
    }
    const bool stop = sum.transmittance * (1 - alpha) < TRANSMITTANCE_MIN;
    visit(i, alpha, sum, stop ? Verdict::stopped : Verdict::blended);
    if (stop && !faults.stop_late) return true;
    add(sum, splat, z_at(splat, pixel.x, pixel.y), alpha);
    if (stop) return true;
  }
  return false;
}

template <typename Visit>
PixelSum blend_pixel(const std::vector<Splat>& splats, std::span<const std::uint32_t> list,
                     const glm::ivec2& pixel, Faults faults, const Visit& visit) {
  PixelSum sum;
  blend_on(sum, splats, list, pixel, faults, visit);
  return sum;
}

}  // namespace binosplat::reference
