#pragma once
// The options that choose how frames are drawn.

#include <iterator>
#include <optional>
#include <string>

#include "render/debug_options.h"
#include "render/frame_settings.h"
#include "render/stage.h"

namespace binosplat::app {

/// Value of DrawingOptions::rule for --threshold adagscale: `peripheral` with the transmittance by depth.
constexpr int whole_adagscale = std::size(threshold_choices);

/// Settings whose threshold and transmittance settings_of() completes.
struct DrawingOptions : render::FrameSettings {
  std::optional<int> rule;              // a Threshold or whole_adagscale; none: as the other options need it
  std::optional<Transmittance> source;  // of T_upper; none: that of the rule
  std::string calibration;              // a file of binosplat calibrate
  std::optional<render::Stage> reference_until;
  int frames = 1;  // number of frames to draw of each view
};

/// Throws Error for contradicting options.
void check(const DrawingOptions& options);

/// The options as settings with a threshold, without calibration and without depth table.
render::FrameSettings settings_of(const DrawingOptions& options);

/// The debug options of a frame (--reference-until).
render::DebugOptions debug_options_of(const DrawingOptions& options);

}  // namespace binosplat::app
