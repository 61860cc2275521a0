#pragma once
// Joins the parts of a scene into one model.

#include "scene/model.h"

namespace binosplat {

/// Appends the Gaussians of `part`; missing higher harmonics are 0. Warns if the two differ in perspective.
void join(Model& all, Model&& part);

}  // namespace binosplat
