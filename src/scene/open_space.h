#pragma once
// Room to stand in, where what a model is about is rooms or streets and not one thing in the middle.

#include <optional>

#include "scene/core.h"
#include "scene/framing.h"
#include "scene/ground.h"

namespace binosplat {

/// A circle to stand on around the middle of the widest open space near the middle of the model, with the
/// eyes `eyes` world units above the ground, which must have a height. Its first place is where one sees
/// farthest across the space. Nothing where there is no floor with room for a person.
std::optional<Capture::Around> open_space(const CoredModel& cored, const Ground& ground, double eyes);

}  // namespace binosplat
