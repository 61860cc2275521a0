#pragma once
// --calibration: chooses the settings of each shot.

#include <vector>

#include "app/drawing_options.h"
#include "app/shots.h"
#include "render/threshold_policy.h"

namespace binosplat::app {

/// Reads the options' calibration, if any. Throws Error if it has no entry for the requested rule.
render::ThresholdPolicy policy_of(const DrawingOptions& options);

/// Returns ThresholdPolicy::settings() for the shot's first eye. Warns if the calibration does not cover the
/// shot, which is then drawn exactly. Also warns if the tolerance is scaled, because dB are then rough.
render::FrameSettings settings_of(const render::ThresholdPolicy& policy, const Shot& shot,
                                  const render::FrameSettings& asked, const ModelAxes& axes);

/// The views in which --transmittance depth measures its table without a calibration: 16 cameras of the list,
/// evenly spaced. Logs their number.
std::vector<shared::View> views_of_depth_table(const Lens& lens, const CameraList& list, double near_plane,
                                               const ModelAxes& axes);

}  // namespace binosplat::app
