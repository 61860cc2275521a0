#pragma once
// Widgets for frame times.

#include <deque>
#include <optional>

#include "render/frame_record.h"

namespace binosplat::preview {

using Frames = std::deque<render::FrameRecord>;

/// Draws the GPU time of the last frame, and the frame rate if known.
void draw_speed(const Frames& frames, const std::optional<double>& frames_a_second);

/// Draws stage times of the last frames as stacked bars, with lines for total time and budget. Marks frames
/// with events, which a tooltip lists. Also lists the stages of the last frame.
void draw_times(const Frames& frames, double budget_ms);

}  // namespace binosplat::preview
