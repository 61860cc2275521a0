#pragma once
// Joins the parts of a scene into one model.

#include "scene/model.h"

namespace binosplat {

/// Appends the Gaussians of `part`; missing higher harmonics become 0. Warns if order or projection differs.
void append_model(Model& all, Model&& part);

}  // namespace binosplat
