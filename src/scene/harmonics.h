#pragma once
// The real spherical harmonics of models, with Condon-Shortley signs, in the order of stored coefficients.

#include <array>
#include <glm/glm.hpp>
#include <span>

namespace binosplat {

/// Evaluates the functions of degrees 0 to 3 at a unit direction.
std::array<double, 16> sh_basis(const glm::dvec3& direction);

/// Returns the sum of one Gaussian's coefficients (coefficient-major, RGB together) times the functions: its
/// colour minus 0.5, before clamping at 0.
glm::dvec3 sh_sum(std::span<const float> sh, const std::array<double, 16>& basis);

/// Rotates or reflects coefficients: afterwards the colour in direction `turn` * d is the earlier colour in
/// direction d. Coefficients mix only within their degree.
class HarmonicsTurn {
 public:
  /// `turn` is orthogonal. If it only flips axes, it only changes signs and rounds nothing.
  explicit HarmonicsTurn(const glm::dmat3& turn);

  /// Rotates one Gaussian's coefficients (coefficient-major, RGB together) in place.
  void apply(float* sh, int degree) const;

 private:
  std::array<std::array<double, 16>, 16> matrix_{};
};

}  // namespace binosplat
