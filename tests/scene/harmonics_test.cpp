#include "scene/harmonics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace binosplat {
namespace {

/// Returns the largest difference from the definition by associated Legendre functions with Condon-Shortley
/// signs.
double farthest_from_definition(const std::array<double, 16>& basis, double polar, double azimuth) {
  double farthest = 0.0;
  std::size_t k = 0;
  for (int degree = 0; degree <= 3; ++degree) {
    for (int order = -degree; order <= degree; ++order) {
      const auto m = static_cast<unsigned>(std::abs(order));
      const double around = order == 0  ? 1.0
                            : order > 0 ? std::sqrt(2.0) * std::cos(m * azimuth)
                                        : std::sqrt(2.0) * std::sin(m * azimuth);
      const double defined = std::sph_legendre(static_cast<unsigned>(degree), m, polar) * around;
      farthest = std::max(farthest, std::abs(basis[k++] - defined));
    }
  }
  return farthest;
}

TEST(Harmonics, MatchDefinition) {
  for (const auto& [polar, azimuth] : {std::pair{0.4, 0.3}, {1.3, 2.1}, {2.6, -0.7}, {1.9, -2.9}}) {
    auto basis =
        sh_basis({std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)});
    EXPECT_LT(farthest_from_definition(basis, polar, azimuth), 1e-14);
    basis[14] = -basis[14];
    EXPECT_GT(farthest_from_definition(basis, polar, azimuth), 1e-3) << "injected";
  }
}

}  // namespace
}  // namespace binosplat
