#pragma once
// Which way is up in a model and where its floor is, found in the model itself, for those without cameras.

#include <array>
#include <glm/glm.hpp>
#include <optional>

#include "scene/core.h"

namespace binosplat {

/// In the world (scene/axes.h).
struct Ground {
  glm::dvec3 up;
  /// How far along `up` the floor lies that reaches around what the model is about, world units; nothing for
  /// an object, which nobody stands in.
  std::optional<double> height;
};

/// From the flat, opaque Gaussians, which lie in surfaces: up is where most of them face, as grounds, floors
/// and tables do, or else what walls have in common; and rather the side on which a model reaches farther.
/// Nothing where no direction stands out, as with models of round Gaussians and those that a network makes.
/// `up`, where it is known, is taken as it is.
std::optional<Ground> find_ground(const CoredModel& cored, const std::optional<glm::dvec3>& up = {});

/// Two directions of length 1 in the plane across `up`, which has length 1: the same ones each time.
std::array<glm::dvec3, 2> level_directions(const glm::dvec3& up);

}  // namespace binosplat
