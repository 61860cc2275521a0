#pragma once
// Chooses the settings of each shot by --calibration, or by a calibration that AdaGScale makes for this run.

#include <memory>

#include "adagscale/calibrated_threshold.h"
#include "app/options/options.h"
#include "app/render/shots.h"
#include "render/gpu_model.h"

namespace binosplat::app {

/// Reads the options' calibration, if the file exists.
adagscale::CalibratedThreshold calibrated_threshold_of(const DrawingOptions& options);

/// Returns CalibratedThreshold::settings() for the shot's first eye. Warns if the calibration does not cover
/// the shot, which is then drawn exactly. Also warns if the tolerance is scaled, because its dB are then
/// rough.
render::FrameSettings settings_of(const adagscale::CalibratedThreshold& calibrated, const Shot& shot,
                                  const render::FrameSettings& asked, const ModelAxes& axes);

/// Measures what AdaGScale needs of a model, in 16 training views of the list. If finds_k(), finds K for
/// --quality (40 dB), logs it, writes it to --calibration, and sets `calibrated` and the settings' rule. If
/// the model's levels change (`has_levels`), instead lets each frame measure its quality. With a --tolerance,
/// measures only the table by depth. Does nothing for other rules.
void measure_adagscale(const Options& options, const std::shared_ptr<render::GpuModel>& model,
                       bool has_levels, const CameraList& list, double near_plane,
                       adagscale::CalibratedThreshold& calibrated, render::FrameSettings& settings);

}  // namespace binosplat::app
