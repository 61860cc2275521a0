#pragma once
// `binosplat view --xr`: a scene of the preview's in a headset.

#include "app/render_options.h"
#include "preview/window.h"

namespace binosplat::app {

/// Until its user ends it, or the window beside it is closed. Throws Error(no_gl), in one line, without
/// OpenXR's loader, runtime or headset, and as xr::run() does.
void view_in_headset(const RenderOptions& options, const preview::Opened& scene, preview::Choices choices);

}  // namespace binosplat::app
