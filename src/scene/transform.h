#pragma once
// Applies an affine transform to a model.

#include <glm/glm.hpp>

#include "scene/model.h"

namespace binosplat {

/// Applies x -> M x + t to a model. The matrix holds the columns of M and t; its last row is 0 0 0 1. Q is
/// the orthogonal factor of M = Q P, with P symmetric without negative eigenvalues (polar decomposition):
/// - means are transformed, and covariances S become M S M^T. M may have unequal scales, shear, reflections
///   or zero scales: any affine transform of a Gaussian is a Gaussian;
/// - harmonics are rotated (and reflected) by Q: the colour in direction Q d is the earlier one in direction
///   d. If P is no uniform scale, M turns some directions differently, and colours are approximate. No
///   harmonics of the same degree would be exact. KHR_gaussian_splatting asks for the rotation nearest to M.
///
/// Appends the new position of each Gaussian to `places`, in doubles. Returns whether all numbers are finite
/// and scales up to 1e13; else the model is unusable. The model must have no scaffold and no origin.
[[nodiscard]] bool transform(Model& model, const glm::dmat4& map, std::vector<glm::dvec3>& places);

}  // namespace binosplat
