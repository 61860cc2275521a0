#pragma once
// Applies an affine map to a model.

#include <glm/glm.hpp>

#include "scene/model.h"

namespace binosplat {

/// Applies x -> M x + t to a model. The matrix holds the columns of M and t; its last row is 0 0 0 1. Q is
/// the orthogonal factor of M = Q P, with P symmetric without negative eigenvalues (polar decomposition):
/// - means are mapped, and covariances S become M S M^T, also if M scales unevenly, shears, mirrors or
///   flattens: any affine map of a Gaussian is a Gaussian;
/// - harmonics are rotated (and mirrored) by Q: the colour along Q d is the earlier one along d. If P is
///   uneven, true directions change otherwise, so colours are approximate. No harmonics of the same degree
///   are exact there, and KHR_gaussian_splatting asks for the rotation nearest to M.
///
/// Appends the new position of each Gaussian to `places`, in doubles. Returns whether all numbers are finite;
/// otherwise the model is unusable. The model must have no scaffold and no origin.
[[nodiscard]] bool transform(Model& model, const glm::dmat4& map, std::vector<glm::dvec3>& places);

}  // namespace binosplat
