#pragma once
// Draws a model in a headset until the user leaves.

#include <functional>

#include "base/clock.h"
#include "xr/session.h"
#include "xr/walk.h"

namespace binosplat::xr {

struct HeadsetSettings {
  double scale = 1.0;  // factor for the texture sizes that the runtime recommends
  /// Drawing settings, with a background, unless the room is behind the model (Instance::blend_mode).
  /// Foveated pictures have no depths. The near plane is in world units at start.units_per_metre. If the
  /// hands enlarge the world, the plane keeps its distance in metres.
  Settings drawing;
  std::optional<Calibration> calibration;  // completes `drawing`
  std::optional<double> budget_ms;         // of a FrameBudget; 0: a share of the period; none: no limit
  Placement start;                         // at the eyes of a standing viewer (upright_at)
};

/// A frame that was passed to the runtime.
struct Drawn {
  Report report;
  std::vector<View> views;
  Clock::time_point begin = {}, end = {};
  double levels_ms = 0.0;   // CPU time for levels of detail
  double period_ms = 0.0;   // the runtime's period of frames
  double display_ms = 0.0;  // display time, relative to the first frame's
  int missed = 0;           // display periods without a new frame, since the previous frame
};

struct Callbacks {
  /// Called after each frame, and repeatedly while the runtime requests no frames. Returning false ends the
  /// session.
  std::function<bool()> step;
  /// Shows the left eye's picture, which is in the lower left corner of the target. May be empty.
  std::function<void(const Target& left, const glm::ivec2& size)> show = {};
  /// For a model with levels of detail: called before each frame of these views. Frames are due every
  /// `period_ms`; the previous one took `drawn_ms`. May change `drawing`. May be empty.
  std::function<void(std::span<const View> views, const Placement& placement, Settings& drawing,
                     double period_ms, double drawn_ms)>
      levels = {};
  /// Receives each frame after it was passed to the runtime.
  std::function<void(Drawn frame)> drawn;
};

/// Draws in the renderer's OpenGL context, which must be current. If the runtime loses a session, waits some
/// seconds for the headset and starts another session. Throws Error(no_gl) for failures of the runtime, and
/// as Renderer::submit does.
void run(Instance& instance, Renderer& renderer, const HeadsetSettings& settings, const Callbacks& callbacks);

}  // namespace binosplat::xr
