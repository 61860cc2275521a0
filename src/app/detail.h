#pragma once
// From --gpu-memory to the levels of detail that fit.

#include "app/shots.h"
#include "formats/detail.h"

namespace binosplat::app {

/// How many Gaussians fit in options.gpu_memory beside what a frame of the views takes, and from where the
/// views see the model, both eyes: known before it is read, unless its own place decides (--orbit, no
/// cameras), where no eye counts.
DetailBudget detail_budget(const RenderOptions& options, const CameraList& list);

}  // namespace binosplat::app
