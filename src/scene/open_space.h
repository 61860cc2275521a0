#pragma once
// Room to stand in, where what a model is about is rooms or streets and not one thing in the middle.

#include <optional>

#include "scene/core.h"
#include "scene/framing.h"
#include "scene/ground.h"

namespace binosplat {

/// A circle to stand on, with eyes so many world units above the ground, which must have a height: around the
/// middle of the widest open space near the middle of the model, the first place where one sees farthest
/// across it. Nothing where there is no floor with room for a person.
std::optional<Capture::Around> open_space(const CoredModel& cored, const Ground& ground, double eyes);

}  // namespace binosplat
