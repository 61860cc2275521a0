#pragma once
// A model moved by any affine map of its space.

#include <glm/glm.hpp>

#include "scene/model.h"

namespace binosplat {

/// Moves a model by x -> M x + t, given as the columns of a matrix whose last row is 0 0 0 1. With Q the
/// orthogonal factor of M = Q P, P symmetric without negative eigenvalues (the polar decomposition):
/// - means are mapped, and covariances become M S M^T, also where M scales unevenly, shears, mirrors or
///   flattens: what a Gaussian becomes under such a map is a Gaussian again;
/// - harmonics are turned by Q, and mirrored where it mirrors, so that a colour is seen from Q d that was
///   seen from d. Where P is not even, directions themselves go another way than by Q, and a model's colours
///   are then not those of one that was trained so; but no harmonics of the same degree could be, and the
///   turn nearest to M is what KHR_gaussian_splatting asks for.
///
/// Appends where each Gaussian comes to lie to `places`, of more digits than the model keeps. Returns whether
/// all numbers are finite; where they are not, the model is of no use any more. Not for models with a
/// scaffold or an origin.
[[nodiscard]] bool transform(Model& model, const glm::dmat4& map, std::vector<glm::dvec3>& places);

}  // namespace binosplat
