#pragma once
// --calibration: chooses the settings of each shot.

#include <vector>

#include "app/options/drawing.h"
#include "app/shots.h"
#include "render/threshold_policy.h"

namespace binosplat::app {

/// Reads the options' calibration, if any. Throws Error if it has no entry for the requested rule.
render::ThresholdPolicy policy_of(const DrawingOptions& options);

/// Returns ThresholdPolicy::settings() for the shot's first eye. Warns if the calibration does not cover the
/// shot, which is then drawn exactly. Also warns if the tolerance is scaled, because its dB are then rough.
render::FrameSettings settings_of(const render::ThresholdPolicy& policy, const Shot& shot,
                                  const render::FrameSettings& asked, const ModelAxes& axes);

/// Without a calibration, --transmittance depth measures its table in these views: 16 evenly spaced cameras.
std::vector<shared::View> views_of_depth_table(const Lens& lens, const CameraList& list, double near_plane,
                                               const ModelAxes& axes);

}  // namespace binosplat::app
