#pragma once
// How somebody who looks at a scene has it drawn and shown.

#include <glm/glm.hpp>
#include <optional>

#include "render/threshold_policy.h"
#include "shared/axes.h"
#include "stereo/rig.h"

namespace binosplat::preview {

/// What the user may change while looking.
struct Choices {
  int layout = LAYOUT_PARALLEL;  // LAYOUT_SEPARATE: the left eye alone
  int show = SHOW_PICTURE;
  double split = 0.5;  // with SHOW_SPLIT: the share of a picture's width that is shown as drawn
  render::FrameSettings settings;
  /// What a calibration of the model says of `settings` that have neither a tolerance nor a quality.
  render::ThresholdPolicy policy;
  bool flipped = false;  // the exact picture is shown in place of that of `settings`
  stereo::RigSettings rig;
  glm::vec3 background{0.0f};
  bool seeks_screen = false;  // rig.convergence is to suit what a model's first picture shows
  bool grid = false;          // on the ground
  bool cameras = false;       // are drawn where they stand
  int saved_width = 0;        // px, of pictures that are saved; 0: the window's
};

/// Another rule, with the tolerance at which a search would begin.
void choose_threshold(render::FrameSettings& settings, int th);

/// Whether pictures are exact: no threshold, and tiles that leave nothing out.
bool is_exact(const render::FrameSettings& settings);

/// The next tile test, or the one before; of exact pictures the next exact one.
void next_tiles(render::FrameSettings& settings, int by);

/// So many dB against the exact pictures; none: exact.
void choose_quality(render::FrameSettings& settings, std::optional<float> db);

/// Changes what cannot be combined to what can, in favour of the threshold that is chosen: no tolerance
/// without one, and so on (docs/method.md 5); and of a quality rather than a tolerance.
void make_consistent(Choices& choices);

}  // namespace binosplat::preview
