#pragma once
// What levels of detail lose in pictures of many parts, beside what each is known to lose by itself.

#include <span>
#include <vector>

#include "gl/context.h"
#include "lab/streamed_sog_writer.h"
#include "scene/model.h"

namespace binosplat::lab {

/// Draws so many pictures of the leaves from among them, at levels that are predicted to have 40 dB by what
/// each loses by itself (`errors`, of level_errors), and compares with the finest of what is seen: parts that
/// overlap lose more, walls that are seen at an angle less. Eyes lie between two Gaussians and look at one of
/// them which nothing hides. Few pictures or none where such eyes are not found; those for which memory does
/// not suffice are there, and not drawn. The same for the same leaves.
std::vector<LossTogether> loss_together(gl::Context& context, std::span<const std::vector<Model>> leaves,
                                        std::span<const LeafErrors> errors, int pictures);

}  // namespace binosplat::lab
