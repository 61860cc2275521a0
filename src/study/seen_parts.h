#pragma once
// What a view shows of the parts of a model: by it levels of detail are chosen (formats/detail.h).

#include <vector>

#include "formats/detail.h"
#include "render/linear_blend.h"
#include "scene/model_parts.h"

namespace binosplat::study {

/// Draws a view of the model that `blend` is of, exactly, with the settings that count then. Distances are
/// means of the logarithm. Throws as LinearBlend does.
std::vector<SeenPart> seen_parts(render::LinearBlend& blend, const Model& model, const ModelParts& parts,
                                 const shared::View& view, const render::FrameSettings& settings);

}  // namespace binosplat::study
