#pragma once
// The core of a model: its subject, without far outliers and background.

#include <glm/glm.hpp>

#include "scene/model.h"

namespace binosplat {

/// The ball around the median position that contains half of the Gaussians (or one more), in the model's
/// frame. Means and boxes fail for trained models, whose outliers and background reach beyond the subject.
struct Core {
  glm::dvec3 middle{0.0};
  double radius = 0.0;  // world units, above 0
};

/// Throws Error if the model is empty.
Core core_of(const Model& model);

/// Refers to a model, and stores its core, which is slow to find in a large one. Throws as core_of() does.
struct CoredModel {
  const Model& model;
  Core core;

  CoredModel(const Model& of) : model(of), core(core_of(of)) {}
};

}  // namespace binosplat
