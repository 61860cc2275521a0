#pragma once
// From --gpu-memory to the levels of detail that fit.

#include <span>

#include "app/render_options.h"
#include "app/shots.h"
#include "stream/load_within.h"

namespace binosplat::app {

/// How many Gaussians of a degree fit in so many MB beside what a frame of these views takes, and what their
/// uploads do where they come `in_parts`.
std::size_t gaussians_that_fit(double megabytes, render::FrameSettings settings,
                               std::span<const shared::View> views, int degree, bool in_parts);

/// How many Gaussians fit in --gpu-memory beside what a frame of the views takes, and from where the
/// views see the model, both eyes: known before it is read, unless its own place decides (--orbit, no
/// cameras), where no eye counts.
DetailBudget detail_budget(const RenderOptions& options, const CameraList& list);

}  // namespace binosplat::app
