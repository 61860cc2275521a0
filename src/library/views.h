#pragma once
// Converts the caller's views for a frame, with positions relative to the model's origin.

#include <binosplat/renderer.h>

#include "scene/model.h"
#include "stereo/eyes.h"

namespace binosplat::library {

/// Throws as stereo::views_from_xr() does.
inline stereo::HeadViews views_of(std::span<const View> views, Placement placement, const glm::dvec3& origin,
                                  const Settings& settings) {
  placement.origin -= origin;
  std::vector<Eye> eyes;
  std::vector<glm::ivec2> sizes;
  for (const View& view : views) {
    eyes.push_back(view.eye);
    sizes.push_back(view.size);
  }
  return stereo::views_from_xr(eyes, placement, sizes, settings.near_plane);
}

}  // namespace binosplat::library
