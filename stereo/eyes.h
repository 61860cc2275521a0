#pragma once
// Converts eyes in OpenXR's form to views.

#include <binosplat/eyes.h>
#include <glm/glm.hpp>
#include <span>

#include "stereo/rig.h"

namespace binosplat::stereo {

/// The views of the eyes of one head, each with its own size in px: two eyes, or both eyes' contexts and
/// insets. Frusta may be asymmetric and eyes canted. Neighbouring views of one orientation and one depth are
/// projected together. Rounding may put such a view before or behind the first, by less than a millionth of
/// its distance from the space's origin. It is then moved to the first one's depth. `near_plane` is in world
/// units. Throws Error(bad_input) for an orientation that is zero or not finite, for angles without a
/// picture, and for an empty picture.
HeadViews views_from_xr(std::span<const Eye> eyes, const Placement& placement,
                        std::span<const glm::ivec2> sizes, double near_plane = near_default);

}  // namespace binosplat::stereo
