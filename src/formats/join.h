#pragma once
// The parts of a scene as one model.

#include "scene/model.h"

namespace binosplat {

/// Adds the Gaussians of `part`; harmonics that one of the two does not have are 0. Says with a warning where
/// the two are seen differently.
void join(Model& all, Model&& part);

}  // namespace binosplat
