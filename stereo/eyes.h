#pragma once
// Views of eyes as OpenXR gives them.

#include <binosplat/eyes.h>
#include <glm/glm.hpp>
#include <span>

#include "stereo/rig.h"

namespace binosplat::stereo {

/// The views of the eyes of one head, each of its own size in px: two eyes, or both eyes' wide pictures and
/// the insets in them. Frusta may be asymmetric and eyes canted. Those of one orientation and, but for
/// rounding, one depth are projected together if they follow one another: they are moved by what rounding
/// put them before or behind the first, less than a millionth of its distance from the space's origin.
/// `near_plane` in world units. Throws Error(bad_input) for an orientation that is not finite or zero, angles
/// that enclose no picture, an empty picture.
HeadViews views_from_xr(std::span<const Eye> eyes, const Placement& placement,
                        std::span<const glm::ivec2> sizes, double near_plane = near_default);

}  // namespace binosplat::stereo
