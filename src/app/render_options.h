#pragma once
// The options of `binosplat render` and of the preview.

#include <string>
#include <vector>

#include "app/camera_options.h"
#include "app/context_options.h"
#include "app/drawing_options.h"
#include "app/output_options.h"
#include "app/rig_options.h"
#include "app/scene_options.h"
#include "app/shard.h"
#include "stereo/foveate.h"

namespace binosplat::app {

/// Options of `binosplat view --xr`.
struct HeadsetOptions {
  bool xr = false;
  double scale = 1.0;               // factor for the sizes that the runtime recommends
  std::optional<double> budget_ms;  // 0: the time that the runtime has for a frame
  std::optional<double> record_s;   // duration to record from the first frame on
  bool mirror = true;               // shows the left eye in a window if there is a display
};

struct RenderOptions {
  SceneOptions scene;
  CameraOptions camera;
  RigOptions rig;
  DrawingOptions drawing;
  ContextOptions context;
  OutputOptions output;
  std::optional<stereo::Foveation> foveate;
  HeadsetOptions headset;          // only for the preview
  Shard shard;                     // which of the views this run draws
  bool resume = false;             // skips views that an earlier run of the same options drew
  std::vector<std::string> given;  // options_given(), for resume
};

/// Adds the options that define the pictures, but not those of output.
void add_picture_options(CLI::App& sub, RenderOptions& options);

/// Adds all options of `render`; `options` must outlive parsing. Wrong values throw CLI::ParseError or Error.
void add_options(CLI::App& sub, RenderOptions& options);

/// Adds the options of the preview. The help ends with the window's keys.
void add_view_options(CLI::App& sub, RenderOptions& options);

/// Whether --quality may also apply to levels of detail, if the scene's files have errors of levels.
bool quality_may_choose_levels(const RenderOptions& options);

/// Throws Error for contradicting options.
void check(const RenderOptions& options);
/// The same for --foveate alone.
void check_foveate(const RenderOptions& options);

}  // namespace binosplat::app
