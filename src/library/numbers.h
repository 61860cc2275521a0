#pragma once
// Numbers of the caller's that are none, or mean nothing.

#include <binosplat/renderer.h>

#include <span>

namespace binosplat::library {

/// Throws Error(bad_input) for eyes and a placement with which no picture can be drawn; stereo::views_from_xr
/// checks frusta.
void check_numbers(std::span<const View> views, const Placement& placement);

/// The same for settings; render::check_choice checks quality and tolerance.
void check_numbers(const Settings& settings);

}  // namespace binosplat::library
