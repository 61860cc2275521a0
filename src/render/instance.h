#pragma once
// Instances: models at their places in the world of a frame.

#include <glm/glm.hpp>
#include <memory>
#include <optional>

#include <binosplat/settings.h>

#include "scene/model.h"
#include "shared/types.h"

namespace binosplat::render {

class GpuModel;

/// The place of a model in the frame's world.
struct InstancePlace {
  /// p = scale * rotation * p_model + translation, world units.
  glm::dmat3 rotation{1.0};
  glm::dvec3 translation{0.0};
  double scale = 1.0;      // above 0
  float opacity = 1.0f;    // from 0 to 1; multiplies each Gaussian's opacity
  DepthTable depth_table;  // with Transmittance::depth, in units of the model; empty: the settings' table

  /// Whether the frame's world is the model's own.
  bool is_plain() const {
    return rotation == glm::dmat3(1.0) && translation == glm::dvec3(0.0) && scale == 1.0 && opacity == 1.0f &&
           depth_table.bounds.empty();
  }
};

/// Converts a model's place in the cameras' world (scene/axes.h) to its place in a frame whose positions have
/// the axes and the origin of `frame`.
InstancePlace in_axes_of(const InstancePlace& in_world, const ModelAxes& model, const ModelAxes& frame);

/// Splits a matrix into a rotation, a uniform scale above 0 and a translation. Returns none for any other
/// matrix.
std::optional<InstancePlace> place_of(const glm::dmat4& matrix);

struct Instance {
  std::shared_ptr<GpuModel> model;
  InstancePlace place;
};

/// Returns the view in the model's own world: it projects a point of the model to the same pixel and depth as
/// `view` projects the placed point. If two views give points equal depths, so do their new views. The caller
/// sets the new view's table by depth.
shared::View view_of_instance(const shared::View& view, const InstancePlace& place);

}  // namespace binosplat::render
