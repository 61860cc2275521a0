#pragma once
// `binosplat view --xr`: the preview's scene in a headset.

#include "app/options/options.h"
#include "preview/window.h"

namespace binosplat::app {

/// Draws until the user ends the session or closes the mirror window. Throws Error(no_gl) without OpenXR's
/// loader, runtime or headset, and as xr::run() does.
void view_in_headset(const Options& options, const preview::Opened& scene, preview::Choices choices);

}  // namespace binosplat::app
