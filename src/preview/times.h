#pragma once
// What frames took, as widgets.

#include <deque>
#include <optional>

#include "render/frame.h"

namespace binosplat::preview {

/// GPU time of the last frame, and how many were shown a second where that is known.
void draw_speed(const std::deque<render::FrameReport>& reports, const std::optional<double>& frames_a_second);

/// Stage times of the last frames as stacked bars, and what the last one came by.
void draw_times(const std::deque<render::FrameReport>& reports);

}  // namespace binosplat::preview
