#pragma once
// --reference-until: the stages' results from the float64 reference, put where the GPU's would be.

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "render/buffers.h"

namespace binosplat::render {

/// Computes the stages up to shape.settings.reference_until on the CPU and uploads everything that later
/// stages read; with Stage::blend the pictures themselves are returned. A shared depth order takes a
/// Gaussian's depth from the first view that draws it. Throws Error for Stage::decode of a model that is not
/// decoded, and for a stage before pairs when the views do not share one: the GPU handles the groups one
/// after the other.
std::vector<Picture> fill_from_reference(const Model& model, const FrameShape& shape,
                                         std::uint32_t groups_max, ModelBuffers& model_buffers,
                                         FrameBuffers& buffers);

}  // namespace binosplat::render
