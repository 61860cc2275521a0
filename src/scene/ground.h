#pragma once
// Finds up and the floor of a model without cameras, from its Gaussians.

#include <array>
#include <glm/glm.hpp>
#include <optional>

#include "scene/core.h"

namespace binosplat {

/// Up and floor, in the world (scene/axes.h).
struct Ground {
  glm::dvec3 up;
  /// Height along `up` of the floor around the core, world units. Unset for an object, which has no floor to
  /// stand on.
  std::optional<double> height;
  double share = 0.0;  // of the model's flat surfaces that lie in the floor
};

/// Uses the flat, opaque Gaussians, which lie in surfaces. Up is the normal of most of them (grounds, floors,
/// tables), or else the direction that all walls share. Of its two senses, up is the one in which the model
/// extends farther. Returns nothing if no direction stands out, as in models of round Gaussians, and for
/// scaffolds. A given `up` is used unchanged.
std::optional<Ground> find_ground(const CoredModel& cored, const std::optional<glm::dvec3>& up = {});

/// Returns two unit vectors that span the plane perpendicular to the unit vector `up`; deterministic.
std::array<glm::dvec3, 2> level_directions(const glm::dvec3& up);

}  // namespace binosplat
