#pragma once
// Measures the error of levels of detail in pictures of many chunks, to compare it with the prediction by
// each chunk's own errors.

#include <span>
#include <vector>

#include "compact/streamed_sog_writer.h"
#include "gl/context.h"
#include "scene/model.h"

namespace binosplat::compact {

/// Draws `pictures` pictures of the chunks (`levels_of_chunks`), from eyes among them. Each uses the levels
/// for which `errors` (of level_errors) predict 40 dB, and is compared with the finest levels of its visible
/// chunks. Overlapping chunks lose more than predicted, walls at a slant less. An eye lies between two
/// Gaussians and looks at one of them. Returns fewer pictures if no such eyes are found. A picture for which
/// memory was short has `drawn` false. Deterministic.
std::vector<JointLoss> joint_losses(gl::Context& context,
                                    std::span<const std::vector<Model>> levels_of_chunks,
                                    std::span<const LevelErrors> errors, int pictures);

}  // namespace binosplat::compact
