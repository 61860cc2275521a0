#include "reference/adagscale_threshold.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"

namespace binosplat::reference {

namespace {

/// The pixels of a tile that a Gaussian of this area covers. Of a Gaussian larger than 64 tiles, a 64th
/// (docs/method.md 5).
double covered_by(double area) { return std::max(std::min(256.0, area), area / 64.0); }

}  // namespace

double threshold(Threshold rule, double tolerance, const Splat& splat, double bound) {
  if (!(bound > 0.0)) fail("upper bound of transmittance {}: expected a number above 0", bound);
  const double sqrt_det = std::sqrt(splat.det);
  switch (rule) {
    case Threshold::exact:
      return ALPHA_MIN;
    case Threshold::adagscale:  // AdaGScale, equation 10: `tolerance` is K, in alpha * px^2
      return tolerance / (bound * 2.0 * std::numbers::pi * sqrt_det) + ALPHA_MIN;
    case Threshold::squared:  // drops pairs that cost less than kappa = `tolerance`, px * squared colour
      return std::max(ALPHA_MIN, std::sqrt(tolerance / covered_by(std::numbers::pi * sqrt_det)) / bound);
  }
  fail("threshold {}: unknown value", static_cast<int>(rule));
}

void set_thresholds(std::vector<Splat>& splats, Threshold rule, double tolerance,
                    std::span<const double> bounds) {
  if (!bounds.empty() && bounds.size() != splats.size()) {
    fail("{} upper bounds of transmittance for {} Gaussians: expected one each", bounds.size(),
         splats.size());
  }
  for (std::size_t i = 0; i < splats.size(); ++i) {
    Splat& splat = splats[i];
    if (!splat.drawn) continue;
    splat.threshold = threshold(rule, tolerance, splat, bounds.empty() ? 1.0 : bounds[i]);
    if (rule != Threshold::exact && splat.threshold > splat.opacity) splat.drawn = false;
  }
}

}  // namespace binosplat::reference
