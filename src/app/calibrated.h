#pragma once
// --calibration: chooses the settings of each shot.

#include <vector>

#include "app/drawing_options.h"
#include "app/shots.h"
#include "render/threshold_policy.h"

namespace binosplat::app {

/// Reads the options' calibration, if any. Throws Error if it has no entry for the requested rule.
render::ThresholdPolicy policy_of(const DrawingOptions& options);

/// As ThresholdPolicy::settings(). Warns if the shot is drawn exactly, or if its dB are rough.
render::FrameSettings settings_of(const render::ThresholdPolicy& policy, const Shot& shot,
                                  const render::FrameSettings& asked, const ModelAxes& axes);

/// The views in which --transmittance depth measures its table without a calibration: 16 cameras of the list,
/// evenly spaced. Logs their number.
std::vector<shared::View> views_of_depth_table(const Lens& lens, const CameraList& list, double near_plane,
                                               const ModelAxes& axes);

}  // namespace binosplat::app
