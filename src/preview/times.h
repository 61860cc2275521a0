#pragma once
// Widgets for frame times.

#include <deque>
#include <optional>

#include "render/profiled_frame.h"

namespace binosplat::preview {

using Frames = std::deque<render::FrameRecord>;

/// Draws the last frame's GPU time, and the frame rate if known.
void draw_speed(const Frames& frames, const std::optional<double>& frames_a_second);

/// Draws the last frames' stage times as stacked bars, with lines for total time and budget. Marks frames
/// with events, which a tooltip lists. Also lists the last frame's stages.
void draw_times(const Frames& frames, double budget_ms);

}  // namespace binosplat::preview
