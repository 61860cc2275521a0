#pragma once
// The options that choose how frames are drawn.

#include <optional>
#include <string>

#include "render/debug_options.h"
#include "render/frame_settings.h"
#include "render/stage.h"

namespace binosplat::app {

struct DrawingOptions : render::FrameSettings {
  std::string calibration;  // a file of binosplat calibrate; if it does not exist, finds_k() writes it
  std::optional<render::Stage> reference_until;
  int frames = 1;  // number of frames to draw of each view

  bool has_calibration() const;  // whether the file exists
};

/// Throws Error for contradicting options.
void check(const DrawingOptions& options);

/// Whether AdaGScale's K must be found for these options: they name the rule, but neither a tolerance nor a
/// calibration that exists.
bool finds_k(const DrawingOptions& options);

/// Whether the model must be measured for these options: K, or the transmittance by depth.
bool measures_model(const DrawingOptions& options);

/// The options as settings with a threshold, unless a calibration chooses it, and without depth table.
render::FrameSettings settings_of(const DrawingOptions& options);

/// The debug options of a frame (--reference-until).
render::DebugOptions debug_options_of(const DrawingOptions& options);

}  // namespace binosplat::app
