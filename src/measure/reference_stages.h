#pragma once
// --reference-until: replaces the results of the first stages by results of the float64 reference, to find
// the stage that has a fault.

#include "render/debug_options.h"

namespace binosplat::measure {

/// The result computes the stages up to `until` on the CPU, and uploads all data that later stages read; with
/// Stage::blend it returns pictures. The frame throws Error for Stage::decode without a Scaffold-GS model,
/// for Stage::bin with a list too long for one work group, and for settings that use earlier frames.
render::StandIn reference_until(render::Stage until);

}  // namespace binosplat::measure
