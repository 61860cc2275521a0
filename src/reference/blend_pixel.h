#pragma once
// One pixel of the blend, docs/method.md 3 to the letter. For this room only.

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

/// What a pixel has gathered so far.
struct PixelSum {
  glm::dvec3 colour{0.0};                                     // C
  double z_sum = 0.0;                                         // Z
  double transmittance = 1.0;                                 // T
  double farthest = std::numeric_limits<double>::infinity();  // nothing is seen beyond this view z
};

enum class Verdict { skipped, blended, stopped };

/// alpha of a splat at pixel (x, y), not yet compared with tau. 0 where it is skipped without a look at the
/// exponential: where q is negative, and where q is so large (beyond 2 ln 255 = 11.08) that even a sigma of 1
/// leaves less than tau.
inline double alpha_at(const Splat& splat, int x, int y) {
  const double q = squared_distance(splat, {x, y});
  if (q < 0.0 || q > 11.1) return 0.0;
  return std::min(ALPHA_MAX, splat.opacity * std::exp(-0.5 * q));
}

/// View z of what pixel (x, y) sees of a splat.
inline double depth_at(const Splat& splat, int x, int y) {
  const glm::dvec3 p(x, y, 1);
  return splat.cone ? splat.depth / std::sqrt(glm::dot(p, splat.cone->ray * p)) : splat.depth;
}

/// Blends one splat at depth z behind what there is.
inline void add(PixelSum& sum, const Splat& splat, double z, double alpha) {
  sum.colour += alpha * sum.transmittance * splat.colour;
  sum.z_sum += alpha * sum.transmittance * z;
  sum.transmittance *= 1 - alpha;
}

/// Blends the list at a pixel behind what there is; whether the pixel ended. For each Gaussian, before
/// it is added, visit(index, alpha, sum so far, verdict) is called.
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
    add(sum, splat, depth_at(splat, pixel.x, pixel.y), alpha);
    if (stop) return true;
  }
  return false;
}

/// The whole of it.
template <typename Visit>
PixelSum blend_pixel(const std::vector<Splat>& splats, std::span<const std::uint32_t> list,
                     const glm::ivec2& pixel, Faults faults, const Visit& visit) {
  PixelSum sum;
  blend_on(sum, splats, list, pixel, faults, visit);
  return sum;
}

}  // namespace binosplat::reference
