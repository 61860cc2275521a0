#pragma once
// Levels of detail: those that --gpu-memory has room for, and with --detail those that follow what is drawn.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "app/render_options.h"
#include "app/shots.h"
#include "base/image.h"
#include "render/frame.h"
#include "stereo/debug_view.h"
#include "stream/load_within.h"
#include "stream/picture_stream.h"
#include "stream/stream.h"

namespace binosplat::app {

/// How many Gaussians of a degree fit in so many MB beside what a frame of these views takes, and what their
/// uploads do where they come `in_parts`.
std::size_t gaussians_that_fit(double megabytes, render::FrameSettings settings,
                               std::span<const shared::View> views, int degree, bool in_parts);

/// How many Gaussians fit in --gpu-memory beside what a frame of the views takes, and from where the
/// views see the model, both eyes: known before it is read, unless its own place decides (--orbit, no
/// cameras), where no eye counts.
DetailBudget detail_budget(const RenderOptions& options, const CameraList& list);

/// Which levels a shot was drawn with, and what that took.
struct ShotLevels {
  std::size_t gaussians = 0;  // of the model
  bool switched = false;      // other levels than the shot before
  double read_ms = 0.0;       // for the files, where they had to be read
  double upload_ms = 0.0;     // for the GPU
  std::optional<double>
      switch_psnr;  // dB, between the shot with the levels before and with these, both exact
  std::optional<double> finest_psnr;     // dB, against the exact picture of the finest levels
  std::optional<double> predicted_psnr;  // the same by the errors of the levels, of the worse eye
  double left = 0.0;                     // dB of settings.quality, for what the frame leaves out of them
};

/// What options say of a stream: --detail, or the finest, or what --quality leaves to levels, of more than
/// few_gaussians; and --gpu-memory for the model and frames of such settings.
StreamSettings stream_settings(const SceneOptions& options, const render::FrameSettings& settings);

/// Opens a scene, with axes and anti-aliasing as options say, for frames that must not wait, which begin with
/// the coarsest levels while the others are read; null where no levels follow what is seen.
std::unique_ptr<Stream> open_for_frames(const SceneOptions& options, const render::FrameSettings& settings);

/// The same for shots that may wait, of a head that turns, or single pictures: those with little memory, or a
/// --detail, go by dB however few Gaussians there are. Throws Error where the scene is no streamed SOG.
std::unique_ptr<PictureStream> open_for_shots(const SceneOptions& options,
                                              const render::FrameSettings& settings, bool heads_turn);

/// Brings the stream's model to the levels that a shot needs, which `frame` and `show` draw; with a
/// background before which pictures lie it reports what a switch of a turning head's levels changes.
ShotLevels settle_shot(PictureStream& stream, render::Frame& frame, stereo::DebugView& show,
                       std::span<const shared::View> views, const render::FrameSettings& settings,
                       const std::optional<glm::vec3>& background);

/// A scene at its finest levels, for --detail-report.
class FinestLevels {
 public:
  /// Reads them.
  FinestLevels(const SceneOptions& options, gl::Context& context);

  /// PSNR of pictures of these views against those of the finest levels, drawn exactly; all are of one mean.
  double psnr(std::span<const shared::View> views, std::span<const Picture> pictures,
              const render::FrameSettings& settings, const glm::vec3& background);

 private:
  Model model_;
  stereo::DebugView show_;
};

}  // namespace binosplat::app
