#pragma once
// --reference-until: the stages' results from the float64 reference, put where the GPU's would be.

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "render/buffers.h"

namespace binosplat::render {

/// Computes the stages up to shape.settings.reference_until on the CPU and uploads everything that later
/// stages read; with Stage::blend the pictures themselves are returned. A shared depth order takes the first
/// view's depths. Throws Error for a stage before pairs when the views do not share one: the GPU handles the
/// groups one after the other.
std::vector<Picture> fill_from_reference(const Model& model, const FrameShape& shape,
                                         std::uint32_t groups_max, FrameBuffers& buffers);

}  // namespace binosplat::render
