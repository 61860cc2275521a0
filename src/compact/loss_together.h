#pragma once
// Measures the error of levels of detail in pictures of many leaves, beside the error that each leaf's own
// predicts.

#include <span>
#include <vector>

#include "compact/streamed_sog_writer.h"
#include "gl/context.h"
#include "scene/model.h"

namespace binosplat::compact {

/// Draws `pictures` pictures of the leaves, from eyes among them, at levels that `errors` (of level_errors)
/// predict to come to 40 dB, and compares each with the picture of the finest levels of what it shows. Leaves
/// that overlap lose more than predicted, walls that are seen at an angle less. An eye lies between two
/// Gaussians and sees one of them. Returns fewer pictures where such eyes are not found; one for which memory
/// did not suffice has `drawn` false. Deterministic.
std::vector<LossTogether> loss_together(gl::Context& context, std::span<const std::vector<Model>> leaves,
                                        std::span<const LeafErrors> errors, int pictures);

}  // namespace binosplat::compact
