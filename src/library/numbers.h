#pragma once
// Numbers of the caller's that are none, or mean nothing.

#include <binosplat/renderer.h>

#include <span>

namespace binosplat::library {

/// Throws Error(bad_input) for views and a placement with which no picture can be drawn. Sizes are checked
/// with the targets, frusta by stereo::views_from_xr and regions by render::check_region.
void check_numbers(std::span<const View> views, const Placement& placement);

/// The same for settings; render::check_choice checks quality and tolerance.
void check_numbers(const Settings& settings);

}  // namespace binosplat::library
