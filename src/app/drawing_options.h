#pragma once
// The options that choose how frames are drawn.

#include <iterator>
#include <optional>
#include <string>

#include "render/debug_options.h"
#include "render/settings.h"
#include "render/stage.h"

namespace binosplat::app {

/// --threshold adagscale: TH_PERIPHERAL with TRANSMITTANCE_DEPTH.
constexpr int whole_adagscale = std::size(th_choices);

struct DrawingOptions {
  int tiles = TILES_ELLIPSE;         // a constant TILES_ of shared/axes.h; other members have TH_ and so on
  std::optional<int> th;             // or whole_adagscale; none: chosen by threshold_of()
  std::optional<float> tolerance;    // K or kappa
  std::optional<int> transmittance;  // none: chosen by transmittance_of()
  std::optional<float> quality;      // dB
  std::string calibration;           // a file of binosplat calibrate
  std::optional<int> order;          // none: as the model was trained
  std::optional<int> projection;
  int precision = PRECISION_FULL;
  std::optional<render::Stage> reference_until;
  int frames = 1;  // number of frames to draw of each view
};

/// Throws Error for contradicting options.
void check(const DrawingOptions& options);

/// The rule (TH_) of --threshold, or render::default_threshold().
int threshold_of(const DrawingOptions& options);
/// The source (TRANSMITTANCE_) of --transmittance, or that of the rule.
int transmittance_of(const DrawingOptions& options);

/// The options as settings, without calibration and without depth table.
render::FrameSettings settings_of(const DrawingOptions& options);

/// The debug options of a frame (--reference-until).
render::DebugOptions debug_options_of(const DrawingOptions& options);

}  // namespace binosplat::app
