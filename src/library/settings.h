#pragma once
// Converts the library's settings to those of src/render.

#include <binosplat/renderer.h>

#include "render/frame.h"

namespace binosplat::library {

/// Throws Error(bad_input) for unknown values and illegal settings. render::Frame checks the other settings.
render::FrameSettings frame_settings(const Settings& from, std::span<const View> views,
                                     int precision = PRECISION_FULL);

/// Returns the TH_ of shared/axes.h of the settings' threshold, or render::default_threshold().
int rule_of(const Settings& settings, bool is_calibrated);

/// Return the number in shared/axes.h. Throw Error(bad_input) for an unknown value.
int precision_of(Precision precision);
int layout_of(Layout layout);

}  // namespace binosplat::library
