#pragma once
// The library's settings as those of src/render.

#include <binosplat/renderer.h>

#include "render/frame.h"

namespace binosplat::library {

/// Precedes the names of settings in errors.
constexpr const char* prefix = "settings.";

/// Throws Error(bad_input) as render::check() does.
render::FrameSettings frame_settings(const Settings& from, std::span<const View> views,
                                     int precision = PRECISION_FULL, bool finds_tolerance = false);

/// Return the number in shared/choices.h. Throw Error(bad_input) for an unknown value.
int precision_of(Precision precision);
int layout_of(Layout layout);

}  // namespace binosplat::library
