#pragma once
// A model in a headset, until its user has seen enough.

#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "render/frame_record.h"
#include "xr/projection.h"

namespace binosplat::xr {

struct HeadsetSettings {
  ProjectionSettings projection;
  render::FrameSettings frame;
  std::optional<double> budget_ms;  // for a frame, by quality and size; 0: a share of the runtime's period
  /// Where a standing viewer's eyes are at first, and what is up: world units, in the model's own frame.
  Camera start;
  glm::dvec3 up{0.0, -1.0, 0.0};
  double units_per_metre = 1.0;
};

/// What goes on beside the headset.
struct Beside {
  /// Called after each frame, and while none is wanted; false ends it all.
  std::function<bool()> step;
  /// Shows the left eye's picture. May be empty.
  std::function<void(const Target& left, const glm::ivec2& size)> show;
  /// For a model with levels of detail; else empty. Called before each frame with the views drawn last:
  /// changes the model on the GPU a little, to what these need. Frames are due every `frame_ms`, and drawing
  /// the last one took `drawn_ms`. Returns the PSNR in dB that the frame itself must keep, since levels lose
  /// a part of what FrameSettings::quality allows; 0: the frame is drawn without a quality.
  std::function<float(std::span<const shared::View> views, double frame_ms, double drawn_ms)> levels;
  /// Takes each frame once it was handed to the runtime, which shows one every `period_ms`. May be empty.
  std::function<void(render::FrameRecord frame, double period_ms)> drawn = {};
};

/// Where OpenXR's space lies at first: its origin at the start camera, 1.6 m lower where it lies on the
/// floor, upright, and with the start camera's heading. Where its origin is not where a head is at first, as
/// in the middle of a room, this head is there, and looks that way.
Placement start_of(const HeadsetSettings& settings, bool on_floor, const Eye* head = nullptr);

/// Draws with the model's OpenGL context, which is current. A session that the runtime loses is followed by
/// another, if the headset is there again within some seconds. Throws Error(no_gl) for what a runtime refuses
/// or loses, and as render::Frame does.
void run(Instance& instance, std::shared_ptr<render::GpuModel> model, const HeadsetSettings& settings,
         const Beside& beside);

}  // namespace binosplat::xr
