#pragma once
// Measures errors of levels in pictures of many chunks, to compare with predictions from single chunks.

#include <span>
#include <vector>

#include "compact/streamed_sog_writer.h"
#include "gl/context.h"
#include "scene/model.h"

namespace binosplat::compact {

/// Draws `pictures` pictures of the chunks (`levels_of_chunks`). Each eye lies between two Gaussians and
/// looks at one of the two. Compares the levels for which `errors` (of level_errors()) predict 40 dB with the
/// finest levels of visible chunks. Overlapping chunks lose more than predicted, and walls seen at a slant
/// lose less. Returns fewer losses if fewer eyes have a full view. If memory was short for a picture, its
/// `drawn` is false. Deterministic.
std::vector<JointLoss> joint_losses(gl::Context& context,
                                    std::span<const std::vector<Model>> levels_of_chunks,
                                    std::span<const LevelErrors> errors, int pictures);

}  // namespace binosplat::compact
