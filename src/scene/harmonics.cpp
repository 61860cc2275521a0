#include "scene/harmonics.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "scene/model.h"

namespace binosplat {

std::array<double, 16> sh_basis(const glm::dvec3& d) {
  const double x = d.x, y = d.y, z = d.z, xx = x * x, yy = y * y, zz = z * z;
  return {sh_c0,
          -0.4886025119029199 * y,
          0.4886025119029199 * z,
          -0.4886025119029199 * x,
          1.0925484305920792 * x * y,
          -1.0925484305920792 * y * z,
          0.31539156525252005 * (2.0 * zz - xx - yy),
          -1.0925484305920792 * x * z,
          0.5462742152960396 * (xx - yy),
          -0.5900435899266435 * y * (3.0 * xx - yy),
          2.890611442640554 * x * y * z,
          -0.4570457994644658 * y * (4.0 * zz - xx - yy),
          0.3731763325901154 * z * (2.0 * zz - 3.0 * xx - 3.0 * yy),
          -0.4570457994644658 * x * (4.0 * zz - xx - yy),
          1.445305721320277 * z * (xx - yy),
          -0.5900435899266435 * x * (xx - 3.0 * yy)};
}

glm::dvec3 sh_sum(std::span<const float> sh, const std::array<double, 16>& basis) {
  glm::dvec3 sum(0.0);
  for (std::size_t k = 0; 3 * k < sh.size(); ++k)
    sum += basis[k] * glm::dvec3(sh[3 * k], sh[3 * k + 1], sh[3 * k + 2]);
  return sum;
}

// The basis is orthonormal, so a matrix entry is the integral of one function times a rotated one. The
// degrees are at most 3: 4 Gauss-Legendre nodes in z by 8 azimuths integrate the products exactly.
HarmonicsTurn::HarmonicsTurn(const glm::dmat3& turn) {
  constexpr double nodes[][2] = {{-0.8611363115940526, 0.3478548451374538},
                                 {-0.3399810435848563, 0.6521451548625461},
                                 {0.3399810435848563, 0.6521451548625461},
                                 {0.8611363115940526, 0.3478548451374538}};
  constexpr int azimuths = 8;
  for (const auto& [z, weight] : nodes) {
    for (int k = 0; k < azimuths; ++k) {
      const double angle = glm::two_pi<double>() * k / azimuths, radius = std::sqrt(1.0 - z * z);
      const glm::dvec3 d(radius * std::cos(angle), radius * std::sin(angle), z);
      const auto there = sh_basis(d), before = sh_basis(glm::transpose(turn) * d);
      for (std::size_t a = 0; a < 16; ++a) {
        for (std::size_t b = 0; b < 16; ++b)
          matrix_[a][b] += weight * glm::two_pi<double>() / azimuths * there[a] * before[b];
      }
    }
  }
  // Rounding errors in place of 0 would turn zero coefficients into small numbers.
  for (auto& row : matrix_) {
    for (double& entry : row) entry = std::abs(entry) < 1e-12 ? 0.0 : entry;
  }
}

void HarmonicsTurn::apply(float* sh, int degree) const {
  std::array<double, 3 * sh_count(3)> before{};
  std::copy_n(sh, 3 * sh_count(degree), before.begin());
  for (int band = 1; band <= degree; ++band) {
    const auto begin = static_cast<std::size_t>(sh_count(band - 1)),
               end = static_cast<std::size_t>(sh_count(band));
    for (std::size_t a = begin; a < end; ++a) {
      for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0.0;
        for (std::size_t b = begin; b < end; ++b) sum += matrix_[a][b] * before[3 * b + c];
        sh[3 * a + c] = static_cast<float>(sum);
      }
    }
  }
}

}  // namespace binosplat
