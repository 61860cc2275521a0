#pragma once
// How a frame is drawn.

#include <optional>
#include <string>

#include "app/cli.h"
#include "render/settings.h"
#include "render/stage.h"
#include "render/workings.h"

namespace binosplat::app {

struct DrawingOptions {
  int tiles = TILES_ELLIPSE;       // TILES_ of shared/axes.h, as are those below by their names
  std::optional<int> th;           // none: threshold_of()
  std::optional<float> tolerance;  // K or kappa
  int transmittance = TRANSMITTANCE_ONE;
  bool adagscale = false;        // --th adagscale: TH_PERIPHERAL with TRANSMITTANCE_DEPTH
  std::optional<float> quality;  // dB
  std::string calibration;       // a file of binosplat calibrate
  std::optional<int> decode;     // of a Scaffold-GS model; none: eyes
  std::optional<int> order;      // none: what the model was trained with
  std::optional<int> projection;
  std::optional<int> tile;  // px; none: chosen
  int precision = PRECISION_FULL;
  std::optional<render::Stage> reference_until;
  int frames = 1;  // of each view
};

/// Adds all of them; `options` must outlive the parsing.
void add_drawing_options(CLI::App& sub, DrawingOptions& options);

/// Throws Error for options that contradict each other.
void check(const DrawingOptions& options);

/// What --th is, TH_: squared where only a tolerance, a quality or a calibration is given, which costs less
/// at equal error than the paper's rule (docs/method.md 8).
int threshold_of(const DrawingOptions& options);

/// What the options say of a frame; of a table of depths or a calibration it knows nothing.
render::FrameSettings settings_of(const DrawingOptions& options);

/// --reference-until.
render::Workings workings_of(const DrawingOptions& options);

}  // namespace binosplat::app
