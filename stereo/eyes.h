#pragma once
// Converts eyes in OpenXR's form to views.

#include <binosplat/eyes.h>
#include <glm/glm.hpp>
#include <span>

#include "stereo/rig.h"

namespace binosplat::stereo {

/// The views of the eyes of one head, each with its own size in px: two eyes, or both eyes' contexts and
/// insets. Successive views of equal orientation and depth (position along the direction) are projected
/// together. Rounding may give parallel eyes different depths. So a view is moved to the first view's depth
/// if their orientations are equal and their depths differ by at most a millionth of the first eye's distance
/// from the space's origin. `near_plane` is in world units. Throws Error(bad_input) for an orientation that
/// is zero or not finite, for angles that span no picture, and for an empty picture.
std::vector<shared::View> views_from_xr(std::span<const Eye> eyes, const Placement& placement,
                                        std::span<const glm::ivec2> sizes, double near_plane = near_default);

}  // namespace binosplat::stereo
