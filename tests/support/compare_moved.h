#pragma once
// Compares a model with its transformed copy: means, covariances, and colours by direction.

#include <algorithm>
#include <glm/gtc/quaternion.hpp>

#include "scene/harmonics.h"
#include "scene/model.h"

namespace binosplat::test {

inline glm::dmat3 covariance_of(const Model& model, std::size_t i) {
  const glm::dvec4 q(model.rotation[i]);
  const glm::dmat3 turn = glm::mat3_cast(glm::dquat(q.x, q.y, q.z, q.w));
  glm::dmat3 square(0.0);
  for (int c = 0; c < 3; ++c) square[c][c] = static_cast<double>(model.scale[i][c]) * model.scale[i][c];
  return turn * square * glm::transpose(turn);
}

struct MovedApart {
  double mean = 0.0;    // largest distance, world units
  double shape = 0.0;   // largest difference of covariances, relative to their largest entry
  double colour = 0.0;  // largest difference of colours
};

/// Compares the Gaussians of `moved` from `first` on with those of `model` under x -> map x. `turn`, an
/// orthogonal matrix, rotates the harmonics.
inline MovedApart apart(const Model& model, const Model& moved, const glm::dmat4& map, const glm::dmat3& turn,
                        std::size_t first = 0) {
  const glm::dmat3 linear(map);
  const std::size_t values = 3 * static_cast<std::size_t>(sh_count(model.degree));
  MovedApart most;
  for (std::size_t i = 0; i < model.count(); ++i) {
    const std::size_t j = first + i;
    const glm::dvec3 mean(map * glm::dvec4(model.position[i], 1.0));
    most.mean = std::max(most.mean, glm::length(glm::dvec3(moved.position[j]) - mean));
    const glm::dmat3 shape = linear * covariance_of(model, i) * glm::transpose(linear);
    const glm::dmat3 found = covariance_of(moved, j);
    double largest = 1e-300, difference = 0.0;
    for (int c = 0; c < 3; ++c) {
      for (int r = 0; r < 3; ++r) {
        largest = std::max(largest, std::abs(shape[c][r]));
        difference = std::max(difference, std::abs(shape[c][r] - found[c][r]));
      }
    }
    most.shape = std::max(most.shape, difference / largest);
    for (const glm::dvec3& d :
         {glm::dvec3(1, 0, 0), glm::dvec3(0, 0.6, -0.8), glm::dvec3(-0.48, 0.64, 0.6)}) {
      const glm::dvec3 before = sh_sum({&model.sh[i * values], values}, sh_basis(d));
      const glm::dvec3 after = sh_sum({&moved.sh[j * values], values}, sh_basis(turn * d));
      most.colour = std::max(most.colour, glm::length(after - before));
    }
  }
  return most;
}

/// Returns whether rounding explains all differences.
inline bool follows(const MovedApart& apart) {
  return apart.mean < 2e-5 && apart.shape < 2e-5 && apart.colour < 1e-5;
}

}  // namespace binosplat::test
