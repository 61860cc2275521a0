#pragma once
// Whether what one frame measured still holds for the next.

#include "render/buffers.h"

namespace binosplat::render {

/// True if the views are the same ones a moment later: as many, of the same pictures, lenses and kind of
/// measurement, each turned by less than 15 degrees and moved by less than a tenth of `median_depth` (of the
/// Gaussians drawn before, world units). After anything else (a cut, a jump) the frame starts as a first one
/// does.
bool continues(const FrameShape& before, const FrameShape& now, double median_depth);

}  // namespace binosplat::render
