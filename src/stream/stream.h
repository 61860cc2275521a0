#pragma once
// Levels of detail for frames, which must not wait for them.

#include "base/clock.h"
#include "stream/head_motion.h"
#include "stream/streamed_model.h"
#include "stream/worker.h"

namespace binosplat {

/// A caller that draws its model calls begin_frame() before each frame.
class Stream : public StreamedModel {
 public:
  Stream(const std::filesystem::path& path, StreamSettings settings)
      : StreamedModel(path, std::move(settings)), worker_(files_, drawn_) {}

  /// Does one of two things within about `ms`. It moves chunks that the worker thread has read into the model
  /// and onto the GPU. Or, if levels are chosen by dB, it draws one view of a visibility pass. The worker
  /// chooses and reads levels for the views. While the views move, the second half of a pass measures the
  /// views predicted for the time when their levels arrive. When the views rest and their levels are
  /// complete, one call takes longer than `ms`, to calibrate the loss of levels. The views belong to
  /// one frame, in the model's frame of reference. Uses the settings `quality` and the settings of
  /// Visibility::measure(). Returns whether the model has changed. Rethrows an error of the worker, which
  /// then stops reading.
  bool begin_frame(std::span<const shared::View> views, const render::FrameSettings& settings, double ms);
  /// Compiles the shaders of begin_frame() for such views, by drawing what it draws. The model does not
  /// change.
  void prepare(std::span<const shared::View> views, const render::FrameSettings& settings);
  /// Returns whether the model has the levels for the views of the last begin_frame(), and no measurement is
  /// due.
  bool settled() const;

  /// Returns the calibrated prediction of the views' PSNR against the finest levels, in dB, for the model's
  /// present levels. It uses the views of the last measurement, and interpolates from the current to the
  /// predicted views as time passes. None if levels are not chosen by dB, or before the first measurement.
  std::optional<double> reported_db() const;

 private:
  bool upload_some(double ms);
  void calibrate_at_rest(const render::FrameSettings& settings);
  bool pass_is_due() const;
  void make_pass(const render::FrameSettings& settings);
  void request(StreamWorker::Request request);
  bool has_all() const;
  bool needs_another_pass() const;
  double loss_factor() const;

  struct Pass {
    std::vector<shared::View> views;         // measured so far: current views, then predicted views
    std::size_t current_views = 0, all = 0;  // number of current views in the pass, and of all
    VisibleChunks visible;                   // visibility in `views`
    Clock::time_point began = {};
    bool is_outdated = false;  // the model has changed since then
  };
  HeadMotion motion_;
  Pass pass_;                        // the last one, or the present one
  int passes_ = 0;                   // complete passes at views_
  bool is_due_ = false;              // whether a request for views_ is due
  bool is_calibrated_ = false;       // for views_
  bool made_pass_ = false;           // whether the last frame drew a view of a pass
  double uploads_in_time_ = 0.0;     // Gaussians for which there was time since the last request
  double uploads_per_ms_ = 1 << 14;  // Gaussians uploaded per ms, measured in the last frames
  StreamWorker worker_;
};

/// The most ms of a frame for begin_frame().
inline constexpr double levels_ms_most = 6.0;

/// Returns the ms for begin_frame() if a frame is due every `frame_ms` and drawing takes `drawn_ms`. It is at
/// least 2.5, since levels would otherwise never arrive, and at most levels_ms_most.
double time_for_levels(double frame_ms, double drawn_ms);

}  // namespace binosplat
