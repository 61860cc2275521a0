#pragma once
// A model in a headset, until its user has seen enough.

#include <functional>

#include "base/clock.h"
#include "xr/session.h"
#include "xr/walk.h"

namespace binosplat::xr {

struct HeadsetSettings {
  double scale = 1.0;  // sides of the textures over those that the runtime recommends
  /// How frames are drawn, with a background. No depths go with foveated pictures. The near plane is for a
  /// metre of start.units_per_metre.
  Settings drawing;
  std::optional<Calibration> calibration;  // which `drawing` is completed by
  std::optional<double> budget_ms;  // for a frame, by quality and size; 0: a share of the runtime's period
  Placement start;                  // at the eyes of a viewer who stands (upright_at)
};

/// A frame that the runtime has.
struct Drawn {
  Report report;
  std::vector<View> views;
  Clock::time_point begin = {}, end = {};
  double levels_ms = 0.0;   // CPU time that levels of detail took
  double period_ms = 0.0;   // the runtime shows a frame so often
  double display_ms = 0.0;  // when it is shown, since the first frame was
  int missed = 0;           // times that something was shown between the last frame and this one
};

/// What goes on beside the headset.
struct Beside {
  /// Called after each frame, and while none is wanted; false ends it all.
  std::function<bool()> step;
  /// Shows the left eye's picture, which lies in the lower left corner of the target. May be empty.
  std::function<void(const Target& left, const glm::ivec2& size)> show = {};
  /// For a model with levels of detail: called before each frame of these views is drawn, of which one is due
  /// every `period_ms` and the last one took `drawn_ms`. May change how it is drawn. May be empty.
  std::function<void(std::span<const View> views, const Placement& placement, Settings& drawing,
                     double period_ms, double drawn_ms)>
      levels = {};
  /// Takes each frame once it was handed to the runtime.
  std::function<void(Drawn frame)> drawn;
};

/// Draws in the OpenGL context that is current, the renderer's. A session that the runtime loses is followed
/// by another, if the headset is there again within some seconds. Throws Error(no_gl) for what a runtime
/// refuses or loses, and as Renderer::submit does.
void run(Instance& instance, Renderer& renderer, const HeadsetSettings& settings, const Beside& beside);

}  // namespace binosplat::xr
