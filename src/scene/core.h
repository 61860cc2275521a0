#pragma once
// What a model is about, whatever lies far around it.

#include <glm/glm.hpp>

#include "scene/model.h"

namespace binosplat {

/// The ball around the median position that holds half of the Gaussians, or one more, in the model's frame.
/// Trained models have far outliers and a background larger than their subject, which would ruin a mean or a
/// box.
struct Core {
  glm::dvec3 middle{0.0};
  double radius = 0.0;  // world units, above 0
};

/// Throws Error if the model is empty.
Core core_of(const Model& model);

/// A model with its core, which takes a while to find in a large model: a caller of several functions that
/// use the core makes this once. Refers to the model. Throws as core_of() does.
struct CoredModel {
  const Model& model;
  Core core;

  CoredModel(const Model& of) : model(of), core(core_of(of)) {}
};

}  // namespace binosplat
