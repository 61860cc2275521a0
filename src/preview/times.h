#pragma once
// What frames took, as widgets.

#include <deque>
#include <optional>

#include "render/frame_record.h"

namespace binosplat::preview {

using Frames = std::deque<render::FrameRecord>;

/// GPU time of the last frame, and how many were shown a second where that is known.
void draw_speed(const Frames& frames, const std::optional<double>& frames_a_second);

/// Stage times of the last frames as stacked bars, under a line of the whole time and one of what a frame may
/// take; marks at frames in which something happened, which the mouse tells; and what the last one came by.
void draw_times(const Frames& frames, double budget_ms);

}  // namespace binosplat::preview
