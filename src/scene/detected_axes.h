#pragma once
// Detects which of two axis conventions a model uses, from known cameras, if its file does not say.

#include <optional>
#include <span>
#include <string>

#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat {

struct DetectedAxes {
  std::string axes;
  std::size_t cameras = 0;  // number of cameras that were tested
  /// Mean share of the Gaussians that a camera sees, in the chosen axes (`seen`) and in the others.
  double seen = 0.0, seen_otherwise = 0.0;
  /// Whether the shares were similar and the ground decided: the model's up agrees with the cameras' up only
  /// in the chosen axes.
  bool by_ground = false;
};

/// Chooses between the model's axes and `others`. First it compares the shares of Gaussians that cameras of
/// the world see: the larger share wins if it is at least twice the other. Otherwise it compares the model's
/// up (scene/ground.h) with the cameras'. Returns nothing if neither test decides. Samples large sets of
/// Gaussians and cameras.
std::optional<DetectedAxes> detect_axes(const Model& model, const std::string& others,
                                        std::span<const Camera> cameras);

}  // namespace binosplat
