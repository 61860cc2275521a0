#pragma once
// The placement of the eyes' space in a model's world, for models and for streams.

#include <binosplat/eyes.h>

#include "scene/axes.h"
#include "scene/model.h"

namespace binosplat::library {

/// Implements SplatModel::placement().
inline Placement placement_in(const Model& model, const glm::dvec3& origin, double units_per_metre) {
  const glm::dmat3 into_model = glm::transpose(world_from_axes(model.axes.letters));
  return {into_model * origin, into_model * Placement{}.axes, units_per_metre};
}

}  // namespace binosplat::library
