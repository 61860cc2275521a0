#pragma once
// --reference-until: replaces the results of the first stages by the float64 reference's, to locate the stage
// of a fault.

#include "render/debug_options.h"

namespace binosplat::measure {

/// Computes the stages up to `until` on the CPU, and uploads all data that later stages read; Stage::blend
/// returns pictures instead. The frame throws Error for Stage::decode without a Scaffold-GS model, and for
/// Stage::bin if a list is too long for one sort. It also does for settings that use earlier frames.
render::StandIn reference_until(render::Stage until);

}  // namespace binosplat::measure
