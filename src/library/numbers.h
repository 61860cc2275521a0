#pragma once
// Checks the caller's numbers.

#include <binosplat/renderer.h>

#include <span>
#include <string>

namespace binosplat::library {

/// Throws Error(bad_input) for views and a placement with which no picture can be drawn. Targets::check
/// checks the sizes, stereo::views_from_xr the frusta, and render::check_region the regions.
void check_numbers(std::span<const View> views, const Placement& placement);

/// The same for an instance, which the text calls `name`.
void check_numbers(const Instance& instance, const std::string& name);

}  // namespace binosplat::library
