#pragma once
// Levels of detail for frames, which never wait for their levels.

#include "base/clock.h"
#include "stream/head_motion.h"
#include "stream/streamed_model.h"
#include "stream/worker.h"

namespace binosplat {

/// A caller that draws the stream's model calls begin_frame() before each frame.
class Stream : public StreamedModel {
 public:
  Stream(const std::filesystem::path& path, StreamSettings settings)
      : StreamedModel(path, std::move(settings)), worker_(files_, drawn_) {}

  /// Within about `ms`, inserts loaded chunks into the model and uploads them or, if levels are chosen by dB,
  /// draws one view of a visibility pass. Meanwhile a worker thread chooses and reads levels. While the views
  /// move, the second half of a pass measures the views predicted for the time when their levels arrive. When
  /// the views rest and their levels are complete, one call takes longer, to calibrate the loss of levels.
  ///
  /// The views belong to one frame, in the model's coordinates. Of the settings, `quality` and those of
  /// Visibility::measure() have an effect. Returns whether the model has changed. Rethrows an error of the
  /// worker, which then stops reading.
  bool begin_frame(std::span<const shared::View> views, const render::FrameSettings& settings, double ms);
  /// Compiles the shaders of begin_frame() for these views by running its passes. The model does not change.
  void prepare(std::span<const shared::View> views, const render::FrameSettings& settings);
  /// Returns whether the model has the levels for the last begin_frame()'s views, and no measurement is due.
  bool settled() const;

  /// Returns the predicted PSNR in dB, calibrated, of the model's present levels against the finest. As time
  /// passes, the prediction changes from the current to the predicted views of the last visibility pass. None
  /// if levels are not chosen by dB, or before the first pass.
  std::optional<double> reported_db() const;

 private:
  bool upload_loaded(double ms);
  void calibrate_at_rest(const render::FrameSettings& settings);
  bool pass_is_due() const;
  void make_pass(const render::FrameSettings& settings);
  void request(StreamWorker::Request request);
  bool has_all() const;
  bool needs_another_pass() const;
  double loss_factor() const;

  struct Pass {
    std::vector<shared::View> views;         // measured so far: current views, then predicted views
    std::size_t current_views = 0, all = 0;  // number of current views in the pass, and of all its views
    VisibleChunks visible;                   // visibility in `views`
    Clock::time_point began = {};
    bool is_outdated = false;  // the model has changed since `began`
  };
  HeadMotion motion_;
  Pass pass_;                        // the present pass, or the last one
  int passes_ = 0;                   // number of complete passes for views_
  bool is_due_ = false;              // whether a request for views_ is due
  bool is_calibrated_ = false;       // whether the loss of levels was calibrated for views_
  bool made_pass_ = false;           // whether the last frame drew a view of a pass
  double uploads_in_time_ = 0.0;     // Gaussians that frames since the last request had time to upload
  double uploads_per_ms_ = 1 << 14;  // Gaussians uploaded per ms, measured in the last frames
  StreamWorker worker_;
};

/// Maximum ms of a frame for begin_frame().
inline constexpr double max_levels_ms = 6.0;

/// Returns the ms for begin_frame() if a frame is due every `frame_ms` and drawing takes `drawn_ms`. The
/// result is at least 2.5, so that levels arrive at all, and at most max_levels_ms.
double time_for_levels(double frame_ms, double drawn_ms);

}  // namespace binosplat
