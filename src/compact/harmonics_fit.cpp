#include "compact/harmonics_fit.h"

#include <algorithm>
#include <cmath>

#include "scene/model.h"

namespace binosplat::compact {

namespace {

// Damping relative to the summed weight of all views, so that a view of little weight hardly counts.
constexpr double inertia = 0.01;

constexpr std::size_t at(std::size_t row, std::size_t column) { return row * (row + 1) / 2 + column; }

std::size_t count_of(int degree) { return static_cast<std::size_t>(sh_count(degree)); }

}  // namespace

void HarmonicsFit::add(const std::array<double, 16>& basis, const glm::dvec3& colour, double weight) {
  for (std::size_t row = 0; row < count_max; ++row) {
    for (std::size_t column = 0; column <= row; ++column)
      normal_matrix_[at(row, column)] += static_cast<float>(weight * basis[row] * basis[column]);
    right_side_[row] += glm::vec3(weight * basis[row] * colour);
  }
  squares_ += static_cast<float>(weight * glm::dot(colour, colour));
}

HarmonicsFit::Coefficients HarmonicsFit::fitted(int degree, const Coefficients& now) const {
  const std::size_t count = count_of(degree);
  Coefficients x{};
  const double held = inertia * static_cast<double>(normal_matrix_[0]);
  if (!(held > 0.0)) {
    std::copy_n(now.begin(), count, x.begin());
    return x;
  }
  // Cholesky factorisation of normal_matrix_ + held * identity, and its two triangular solves.
  std::array<double, count_max*(count_max + 1) / 2> l{};
  for (std::size_t row = 0; row < count; ++row) {
    x[row] = glm::dvec3(right_side_[row]) + held * now[row];
    for (std::size_t column = 0; column <= row; ++column) {
      double sum = static_cast<double>(normal_matrix_[at(row, column)]) + (row == column ? held : 0.0);
      for (std::size_t k = 0; k < column; ++k) sum -= l[at(row, k)] * l[at(column, k)];
      l[at(row, column)] = row == column ? std::sqrt(std::max(sum, held)) : sum / l[at(column, column)];
    }
    for (std::size_t k = 0; k < row; ++k) x[row] -= l[at(row, k)] * x[k];
    x[row] /= l[at(row, row)];
  }
  for (std::size_t row = count; row-- > 0;) {
    for (std::size_t k = row + 1; k < count; ++k) x[row] -= l[at(k, row)] * x[k];
    x[row] /= l[at(row, row)];
  }
  return x;
}

double HarmonicsFit::change(int degree, const Coefficients& now) const {
  const Coefficients x = fitted(degree, now);
  double sum = static_cast<double>(squares_);
  for (std::size_t row = 0; row < count_of(degree); ++row) {
    sum -= 2.0 * glm::dot(x[row], glm::dvec3(right_side_[row]));
    for (std::size_t column = 0; column <= row; ++column)
      sum += (row == column ? 1.0 : 2.0) * static_cast<double>(normal_matrix_[at(row, column)]) *
             glm::dot(x[row], x[column]);
  }
  return std::max(0.0, sum / 3.0);
}

}  // namespace binosplat::compact
