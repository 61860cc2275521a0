#pragma once
// In which of two frames the numbers of a model are, where its file does not say so and cameras are known.

#include <optional>
#include <span>
#include <string>

#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat {

struct DetectedAxes {
  std::string axes;
  std::size_t cameras = 0;  // how many they were detected by
  /// The shares of the Gaussians that these cameras have in view, in the mean, in these axes and in the
  /// others.
  double seen = 0.0, seen_otherwise = 0.0;
  bool by_ground = false;  // both are seen, and the ground that is found in the model is below in these only
};

/// Chooses between the model's axes and `others` those in which cameras of the world look at the model: they
/// have at least twice as many of its Gaussians in view, or, where both are seen, the side of the model that
/// is found to be up (scene/ground.h) is up for them. Nothing where neither decides. Of many Gaussians and
/// cameras it looks at a part.
std::optional<DetectedAxes> detect_axes(const Model& model, const std::string& others,
                                        std::span<const Camera> cameras);

}  // namespace binosplat
