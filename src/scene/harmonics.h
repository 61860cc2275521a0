#pragma once
// The spherical harmonics of models: real, with Condon-Shortley signs, in the order in which coefficients are
// stored.

#include <array>
#include <glm/glm.hpp>
#include <span>

namespace binosplat {

/// The functions of degrees 0 to 3 at a unit direction.
std::array<double, 16> sh_basis(const glm::dvec3& direction);

/// The sum of one Gaussian's coefficients, coefficient-major with RGB together, by the functions: its colour
/// less 0.5, which may be below 0.
glm::dvec3 sh_sum(std::span<const float> sh, const std::array<double, 16>& basis);

/// What coefficients become where a model is turned or mirrored: its colour towards `turn` * d is then what
/// it was towards d. Each degree is mixed within itself.
class HarmonicsTurn {
 public:
  /// `turn` is orthogonal. Signed permutations of the axes change signs, and nothing else, exactly.
  explicit HarmonicsTurn(const glm::dmat3& turn);

  /// Turns one Gaussian's coefficients, coefficient-major with RGB together, in place.
  void apply(float* sh, int degree) const;

 private:
  std::array<std::array<double, 16>, 16> matrix_{};
};

}  // namespace binosplat
