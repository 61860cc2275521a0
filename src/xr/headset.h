#pragma once
// A model in a headset, until its user has seen enough.

#include <binosplat/stream.h>

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
  /// For a stream: the ms that its levels may take of a frame of `period_ms`, of which drawing takes
  /// `drawn_ms`.
  std::function<double(double period_ms, double drawn_ms)> levels_ms = {};
  /// For a stream: the PSNR in dB that a frame itself must keep, where its levels lose a part of a quality.
  std::function<float(float quality)> quality = {};
  /// Takes each frame once it was handed to the runtime.
  std::function<void(Drawn frame)> drawn;
};

/// Draws in the OpenGL context that is current, the renderer's. Of a stream, which the renderer draws, levels
/// of detail come before each frame; null: there is none. A session that the runtime loses is followed by
/// another, if the headset is there again within some seconds. Throws Error(no_gl) for what a runtime refuses
/// or loses, and as Renderer::submit does.
void run(Instance& instance, Renderer& renderer, SplatStream* stream, const HeadsetSettings& settings,
         const Beside& beside);

}  // namespace binosplat::xr
