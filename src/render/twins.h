#pragma once
// --reference-until: the stages' results from the float64 reference, put where the GPU's would be.

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "render/buffers.h"

namespace binosplat::render {

/// Computes the stages up to shape.settings.reference_until on the CPU and uploads everything that later stages read;
/// with Stage::blend the pictures themselves are returned. Views of one order group are ordered by the first one's depths.
std::vector<Picture> fill_from_reference(const Model& model, const FrameShape& shape, std::uint32_t groups_max,
                                         FrameBuffers& buffers);

}  // namespace binosplat::render
