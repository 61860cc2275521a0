#pragma once
// Fits harmonics of a lower degree to the colours that a Gaussian has towards the views that show it.

#include <array>
#include <glm/glm.hpp>

namespace binosplat::compact {

/// The colours of one Gaussian towards some views, as sums from which harmonics of degrees 0 to 2 are fitted:
/// weighted least squares.
class ColourFit {
 public:
  using Coefficients = std::array<glm::dvec3, 9>;  // those beyond the degree asked for are 0

  /// A colour that harmonics of `basis` (sh_basis) make, less 0.5, and how much of the picture it is, px.
  void add(const std::array<double, 16>& basis, const glm::dvec3& colour, double weight);

  /// The least-squares coefficients of a degree. Those that no view determines stay near `now`, the present
  /// ones.
  Coefficients fitted(int degree, const Coefficients& now) const;

  /// How much the colours then change, px * squared colour, in the mean of the channels.
  double change(int degree, const Coefficients& now) const;

 private:
  static constexpr std::size_t count_max = 9;
  std::array<float, count_max*(count_max + 1) / 2> gram_{};  // of the basis, lower triangle by rows
  std::array<glm::vec3, count_max> seen_{};                  // the basis by the colours
  float square_ = 0.0f;                                      // of the colours
};

}  // namespace binosplat::compact
