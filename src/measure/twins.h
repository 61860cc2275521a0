#pragma once
// --reference-until: the stages' results from the float64 reference, put where the GPU's would be, so that a
// wrong picture is bisected to its stage.

#include "render/workings.h"

namespace binosplat::measure {

/// Computes the stages up to `until` on the CPU and uploads everything that later stages read; with
/// Stage::blend the pictures themselves are returned. The frame throws Error for Stage::decode of a model
/// that is not decoded, for Stage::bin where a list is too long to be sorted at once, and for settings that
/// use earlier frames.
render::StandIn reference_until(render::Stage until);

}  // namespace binosplat::measure
