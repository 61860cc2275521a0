#pragma once
// Whether what one frame measured still holds for the next.

#include "render/shape.h"

namespace binosplat::render {

/// True if the views are the same ones a moment later: as many, of the same pictures and lenses, each turned
/// by less than 15 degrees and moved by less than a tenth of `median_depth` (of the Gaussians drawn before,
/// world units). Anything else is a cut.
/// `share` of these limits, for a closer look.
bool continues(const FrameShape& before, const FrameShape& now, double median_depth, double share = 1.0);

/// True if `before` measured what `now` goes by. After anything else the frame starts as a first one does.
bool remembers(const FrameShape& before, const FrameShape& now, double median_depth);

}  // namespace binosplat::render
