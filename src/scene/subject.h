#pragma once
// Finds what a picture of a model should show, from a sample of its Gaussians. Lengths are in core radii from
// the core's middle, directions are the world's (scene/axes.h).

#include <glm/glm.hpp>
#include <vector>

#include "scene/core.h"

namespace binosplat {

/// A visible Gaussian.
struct SampledSplat {
  glm::dvec3 place;
  glm::dmat3 half_axes;  // of the ellipsoid outside of which the Gaussian's alpha is invisible
  double cover;          // opacity times area, seen along its smallest axis; for all that the sample left out

  /// Returns how far the ellipsoid reaches in a direction of length 1.
  double reach(const glm::dvec3& direction) const { return glm::length(direction * half_axes); }
};

/// Returns a sample of the visible Gaussians. Empty for scaffolds, whose Gaussians depend on the eye.
std::vector<SampledSplat> visible_splats(const CoredModel& cored);

/// Returns whether a viewer at `eye` who looks along `forward` also has parts of the model behind: then the
/// model is a scene, which goes on in all directions. `forward` and `up` are perpendicular.
bool surrounds(const std::vector<SampledSplat>& splats, const glm::dvec3& eye, const glm::dvec3& forward,
               const glm::dvec3& up);

/// Returns whether nothing is nearer than `near` to an eye, so that a person could stand there.
bool is_free(const std::vector<SampledSplat>& splats, const glm::dvec3& eye, double near);

/// Returns the splats that hang together, without floaters: small parts far from the rest.
std::vector<SampledSplat> without_floaters(const std::vector<SampledSplat>& splats);

}  // namespace binosplat
