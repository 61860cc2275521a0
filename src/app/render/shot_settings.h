#pragma once
// --calibration: chooses the settings of each shot.

#include <memory>

#include "app/options/drawing.h"
#include "app/render/shots.h"
#include "render/calibrated_threshold.h"

namespace binosplat::app {

/// Reads the options' calibration, if any. Throws Error if it has no entry for the requested rule.
render::CalibratedThreshold calibrated_threshold_of(const DrawingOptions& options);

/// Returns CalibratedThreshold::settings() for the shot's first eye. Warns if the calibration does not cover
/// the shot, which is then drawn exactly. Also warns if the tolerance is scaled, because its dB are then
/// rough.
render::FrameSettings settings_of(const render::CalibratedThreshold& calibrated, const Shot& shot,
                                  const render::FrameSettings& asked, const ModelAxes& axes);

/// With --transmittance depth and without a calibration, measures settings.depth_table in 16 evenly spaced
/// cameras of the list.
void measure_depths(Settings& settings, const render::CalibratedThreshold& calibrated,
                    const std::shared_ptr<render::GpuModel>& model, const Lens& lens, const CameraList& list,
                    double near_plane);

}  // namespace binosplat::app
