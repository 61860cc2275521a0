#pragma once
// Fits harmonics of a lower degree to the colours of a Gaussian in the views that show it.

#include <array>
#include <glm/glm.hpp>

namespace binosplat::compact {

/// Sums over a Gaussian's views, to fit harmonics of degrees 0 to 2 to its colours (weighted least squares).
class HarmonicsFit {
 public:
  using Coefficients = std::array<glm::dvec3, 9>;  // those beyond the fitted degree are 0

  /// Adds the Gaussian's colour minus 0.5 in a view. `basis` is sh_basis() of the direction from the eye to
  /// the Gaussian. `weight` is the Gaussian's visible area in the picture, px.
  void add(const std::array<double, 16>& basis, const glm::dvec3& colour, double weight);

  /// Returns the least-squares coefficients up to a degree; near `now` if no view determines them.
  Coefficients fitted(int degree, const Coefficients& now) const;

  /// Returns how much fitted() changes the colours: squared, times px; sum over views, mean over channels.
  double change(int degree, const Coefficients& now) const;

 private:
  static constexpr std::size_t count_max = 9;
  std::array<float, count_max*(count_max + 1) / 2> normal_matrix_{};  // lower triangle by rows
  std::array<glm::vec3, count_max> right_side_{};                     // sums of basis times colour
  float squares_ = 0.0f;                                              // sum of squared colours
};

}  // namespace binosplat::compact
