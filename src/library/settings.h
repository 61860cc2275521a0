#pragma once
// The library's plain settings and report as the rooms below have them.

#include <binosplat/renderer.h>

#include "render/frame.h"

namespace binosplat::library {

/// Throws Error(bad_input) for values and settings that no frame has; render::Frame checks the rest.
render::FrameSettings frame_settings(const Settings& from, std::span<const View> views,
                                     int precision = PRECISION_FULL);

/// TH_ of shared/axes.h: without a threshold, a tolerance and a quality `otherwise`.
int rule_of(const Settings& settings, int otherwise);
Threshold threshold_of(int number);
int transmittance_of(Transmittance transmittance);  // TRANSMITTANCE_
Transmittance transmittance_of(int number);

/// One of shared/axes.h. Throw Error(bad_input) for a number that names none.
int precision_of(Precision precision);
int layout_of(Layout layout);

Report report_of(const render::FrameReport& frame);

}  // namespace binosplat::library
