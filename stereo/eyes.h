#pragma once
// Converts eyes in OpenXR's form to views.

#include <binosplat/eyes.h>
#include <glm/glm.hpp>
#include <span>

#include "stereo/rig.h"

namespace binosplat::stereo {

/// The views of the eyes of one head, each with its own size in px: two eyes, or both eyes' contexts and
/// insets. Successive views of equal orientation and depth are projected together. Rounding may separate the
/// depths of parallel eyes. So a view of the first view's orientation is moved to the first view's depth, if
/// its depth is off by less than a millionth of the first eye's distance from the space's origin.
/// `near_plane` is in world units. Throws Error(bad_input) for an orientation that is zero or not finite, for
/// angles that span no picture, and for an empty picture.
HeadViews views_from_xr(std::span<const Eye> eyes, const Placement& placement,
                        std::span<const glm::ivec2> sizes, double near_plane = near_default);

}  // namespace binosplat::stereo
