#pragma once
// From --gpu-memory to the levels of detail that fit.

#include <span>

#include "app/shots.h"
#include "formats/detail.h"

namespace binosplat::app {

/// How many Gaussians of a degree fit in options.gpu_memory beside what a frame of these views takes.
std::size_t gaussians_that_fit(const RenderOptions& options, std::span<const shared::View> views, int degree);

/// How many Gaussians fit in options.gpu_memory beside what a frame of the views takes, and from where the
/// views see the model, both eyes: known before it is read, unless its own place decides (--orbit, no
/// cameras), where no eye counts.
DetailBudget detail_budget(const RenderOptions& options, const CameraList& list);

}  // namespace binosplat::app
