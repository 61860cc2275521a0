#pragma once
// What is printed of many frames together, and of a run as a whole.

#include "app/render_report.h"

namespace binosplat::app {

/// dB that a frame says of itself: with what its levels lose, where they share --quality.
double reported_psnr(const Drawn& drawn);
/// Whether that was not measured on all of the frame.
bool is_estimate(const Drawn& drawn);

/// Prints how the disparities of a pair lie.
void print_comfort(const Drawn& drawn);

/// Whether many frames belong together, as those of a path or a video: lines for each would bury what they
/// say.
bool is_way(const RenderReport& report);

/// Prints all frames of a way in a few lines: medians, and what is worst.
void print_way(const RenderReport& report);

/// Says so where --quality takes longer than exact frames, which are better, too: in small pictures drawn by
/// a CPU most tiles are drawn exactly as well, to know the error.
void tell_whether_quality_pays(const RenderReport& report);

/// After a run of several shots that took more than a second: what it spent that with.
void print_run(const RenderReport& report);

}  // namespace binosplat::app
