#pragma once
// Draws the frames of a profile at their rate.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lab/profile.h"
#include "stereo/drawing.h"
#include "stream/stream.h"

namespace binosplat::lab {

struct ProfileInput {
  std::vector<std::vector<shared::View>> frames;  // the views of each frame
  render::FrameSettings settings;
  double fps = 0.0;        // frame rate; 0: as fast as possible
  bool asks_clock = true;  // reads the GPU's clock rate
};

class ProfileDrawer {
 public:
  /// `stream` owns the model if its levels follow the views; else `stream` is null. `run` and `stream` must
  /// outlive this object.
  ProfileDrawer(std::shared_ptr<render::GpuModel> model, const ProfileInput& run, Stream* stream);

  /// Draws the first frame until the GPU's clock is high, programs are compiled and levels are loaded. None
  /// of these frames is recorded. Returns the time of the last one in ms.
  double warm_up();

  /// Draws and records all frames. The first one uses no earlier measurements. At a fixed frame rate, each
  /// frame begins at a multiple of the period; a late frame delays all that follow by whole periods.
  render::Recording record(const std::function<void(std::size_t done)>& progress);

  /// CPU time of each recorded frame, all threads; empty unless the CPU draws.
  const std::vector<CpuUse>& cpu() const { return cpu_; }

  /// A small picture of the left eye in a frame, at the current levels.
  Image picture(std::size_t frame);

  /// Measures the time that `quality_db` would save in a frame. Returns none if the profile's own frames are
  /// inexact or foveated, or if they take too long to measure (slow_ms).
  std::optional<Saving> saving(std::size_t frame, double quality_db);

 private:
  render::FrameLevels follow_levels(std::span<const shared::View> views, double drawn_ms);
  render::FrameSettings settings_now() const;

  const ProfileInput& run_;
  Stream* stream_;
  gl::Context& context_;
  stereo::Drawing drawing_;
  std::shared_ptr<const gl::GpuClock> clock_;
  std::vector<CpuUse> cpu_;
};

}  // namespace binosplat::lab
