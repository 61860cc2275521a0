#pragma once
// --calibration: which settings a shot is drawn with.

#include <vector>

#include "app/drawing_options.h"
#include "app/shots.h"
#include "render/threshold_policy.h"

namespace binosplat::app {

/// Reads the options' file, if they name one; it must have an entry for what they ask for (else: Error).
render::ThresholdPolicy policy_of(const DrawingOptions& options);

/// As ThresholdPolicy::settings(), with a warning where the shot is drawn exactly, or its dB are rough.
render::FrameSettings settings_of(const render::ThresholdPolicy& policy, const Shot& shot,
                                  const render::FrameSettings& asked, const ModelAxes& axes);

/// What --transmittance depth is measured in where no calibration has a table: 16 cameras of the list, evenly
/// chosen. Says so.
std::vector<shared::View> views_of_depth_table(const Lens& lens, const CameraList& list, double near_plane,
                                               const ModelAxes& axes);

}  // namespace binosplat::app
