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

/// Of `binosplat view --xr`.
struct HeadsetOptions {
  bool xr = false;
  double scale = 1.0;               // of the sizes that the runtime recommends
  std::optional<double> budget_ms;  // 0: what the runtime has for a frame
  std::optional<double> record_s;   // so much is recorded, from the first frame on
  bool mirror = true;               // the left eye in a window, where there is a display
};

struct RenderOptions {
  SceneOptions scene;
  CameraOptions camera;
  RigOptions rig;
  DrawingOptions drawing;
  ContextOptions context;
  OutputOptions output;
  std::optional<stereo::Foveation> foveate;
  HeadsetOptions headset;          // of the preview
  Shard shard;                     // of the views
  bool resume = false;             // what is there of this run is not drawn again
  std::vector<std::string> given;  // options_given(), for resume
};

/// Adds those that say which pictures are drawn, and how; nothing of what is done with them.
void add_picture_options(CLI::App& sub, RenderOptions& options);

/// Adds all of them to the sub-command; `options` must outlive the parsing. Values that cannot be understood
/// end it with CLI::ParseError or Error.
void add_options(CLI::App& sub, RenderOptions& options);

/// Adds those that the preview takes. The help ends with the window's keys.
void add_view_options(CLI::App& sub, RenderOptions& options);

/// Whether --quality is for levels of detail, too, if the scene has any that tell what they lose.
bool may_share(const RenderOptions& options);

/// Throws Error for options that contradict each other, within a part and between them;
void check(const RenderOptions& options);
/// of --foveate alone.
void check_foveate(const RenderOptions& options);

}  // namespace binosplat::app
