#pragma once
// The user's choices of drawing and display, which may change while the preview runs.

#include <glm/glm.hpp>
#include <optional>

#include "adagscale/calibrated_threshold.h"
#include "shared/choices.h"
#include "stereo/rig.h"

namespace binosplat::preview {

struct Choices {
  int layout = LAYOUT_PARALLEL;  // LAYOUT_SEPARATE shows only the left eye
  int show = SHOW_PICTURE;
  double split = 0.5;  // with SHOW_SPLIT: share of the picture's width that shows `settings`
  render::FrameSettings settings;
  /// Applies if `settings` have neither a tolerance nor a quality.
  adagscale::CalibratedThreshold calibrated;
  bool flipped = false;  // shows the exact picture instead
  stereo::RigSettings rig;
  glm::vec3 background{0.0f};
  bool seeks_screen = false;  // sets rig.convergence to suit a model's first picture
  bool grid = false;          // shows a grid on the ground
  bool cameras = false;       // shows the cameras
  int saved_width = 0;        // px, of saved pictures; 0: the window's
};

/// Chooses a threshold rule, with its starting_tolerance (render/rules.h).
void choose_threshold(render::FrameSettings& settings, Threshold threshold);

/// Whether pictures are exact: no threshold, and a tile test that includes every visible pair.
bool is_exact(const render::FrameSettings& settings);

/// Chooses the next tile test (`by` 1) or the previous one (-1). If pictures are exact, skips inexact tests.
void next_tiles(render::FrameSettings& settings, int by);

/// Chooses a quality in dB against exact pictures; none: exact.
void choose_quality(render::FrameSettings& settings, std::optional<float> db);

/// Resolves conflicts in favour of the chosen threshold rule: for example, exact frames have no tolerance
/// (docs/method.md 5). A quality has precedence over a tolerance.
void make_consistent(Choices& choices);

}  // namespace binosplat::preview
