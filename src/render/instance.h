#pragma once
// Models at their places in the world of a frame.

#include <glm/glm.hpp>
#include <memory>

#include <binosplat/settings.h>

#include "shared/types.h"

namespace binosplat::render {

class GpuModel;

/// Where a model lies in the frame's world, and how it is drawn there.
struct InstancePlace {
  /// p = scale * rotation * p_model + translation, world units.
  glm::dmat3 rotation{1.0};
  glm::dvec3 translation{0.0};
  double scale = 1.0;      // above 0
  float opacity = 1.0f;    // from 0 to 1, times each Gaussian's
  DepthTable depth_table;  // with TRANSMITTANCE_DEPTH, in units of the model; empty: the settings'

  /// Whether the model is drawn as if it were alone in its own world.
  bool is_plain() const {
    return rotation == glm::dmat3(1.0) && translation == glm::dvec3(0.0) && scale == 1.0 && opacity == 1.0f &&
           depth_table.bounds.empty();
  }
};

struct Instance {
  std::shared_ptr<GpuModel> model;
  InstancePlace place;
};

/// The view as the model sees it: it maps the model's points to where `view` maps them in the world. Views of
/// equal depths stay so. Its table of depths is the caller's to set.
shared::View view_of_instance(const shared::View& view, const InstancePlace& place);

}  // namespace binosplat::render
