#pragma once
// Draws the frames of a profile, at their rate.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lab/profile.h"
#include "stereo/foveate.h"
#include "stream/stream.h"

namespace binosplat::lab {

/// What is drawn, and when.
struct ProfileRun {
  std::vector<std::vector<shared::View>> frames;  // the views of each
  render::FrameSettings settings;
  std::optional<stereo::Foveation> foveation;
  double fps = 0.0;  // frames begin so often a second; 0: as soon as the last one is drawn
  bool asks_clock = true;
};

class ProfileDrawer {
 public:
  /// `stream`: whose model it is, if its levels follow what is seen; else null. Both must outlive this.
  ProfileDrawer(std::shared_ptr<render::GpuModel> model, const ProfileRun& run, Stream* stream);

  /// Draws the first frame again and again, until the GPU's clock is up, its programs are compiled and its
  /// levels are there: none of that counts. Returns the ms of the last of these frames.
  double warm_up();

  /// Draws all frames as a head sees them that begins there: nothing was measured before. A frame that is
  /// still being drawn when the next one is due lets that one, and all those due meanwhile, begin later.
  render::Recording record(const std::function<void(std::size_t done)>& progress);

  /// Where the CPU draws: what each recorded frame took of it, all threads together; else empty.
  const std::vector<CpuUse>& cpu() const { return cpu_; }

  /// The left eye's picture of a frame, small, as the levels are now.
  Image picture(std::size_t frame);

  /// What the frame would save at `quality_db`, if it is drawn exactly; nothing where that takes long.
  std::optional<Saving> saving(std::size_t frame, double quality_db);

 private:
  render::FrameReport draw(std::span<const shared::View> views, const render::FrameSettings& settings);
  render::FrameLevels follow_levels(std::span<const shared::View> views, double drawn_ms);
  render::FrameSettings settings_now() const;

  const ProfileRun& run_;
  Stream* stream_;
  gl::Context& context_;
  stereo::FoveatedFrame frame_;
  std::shared_ptr<const gl::GpuClock> clock_;
  std::vector<CpuUse> cpu_;
};

}  // namespace binosplat::lab
