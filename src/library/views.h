#pragma once
// Converts the caller's views for a frame, with positions relative to the model's origin.

#include <binosplat/renderer.h>

#include "scene/axes.h"
#include "scene/model.h"
#include "stereo/eyes.h"

namespace binosplat::library {

/// The near plane of the settings, or else of the training; world units.
inline double near_plane_of(const Settings& settings, const Training& training) {
  return settings.near_plane.value_or(training.near_plane.value_or(near_default));
}

/// Implements SplatModel::placement(): the placement of the eyes' space in a model's world.
inline Placement placement_in(const Model& model, const glm::dvec3& origin, double units_per_metre) {
  const glm::dmat3 into_model = glm::transpose(world_from_axes(model.axes.letters));
  return {into_model * origin, into_model * Placement{}.axes, units_per_metre};
}

/// Throws as stereo::views_from_xr() does.
inline std::vector<shared::View> views_of(std::span<const View> views, Placement placement,
                                          const glm::dvec3& origin, const Settings& settings,
                                          const Training& training) {
  placement.origin -= origin;
  std::vector<Eye> eyes;
  std::vector<glm::ivec2> sizes;
  for (const View& view : views) {
    eyes.push_back(view.eye);
    sizes.push_back(view.size);
  }
  return stereo::views_from_xr(eyes, placement, sizes, near_plane_of(settings, training));
}

}  // namespace binosplat::library
