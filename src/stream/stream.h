#pragma once
// Levels of detail for frames that must not wait for them.

#include "base/clock.h"
#include "stream/head_motion.h"
#include "stream/streamed_model.h"
#include "stream/worker.h"

namespace binosplat {

/// Whoever draws its model calls begin_frame() before each frame.
class Stream : public StreamedModel {
 public:
  Stream(const std::filesystem::path& path, StreamSettings settings)
      : StreamedModel(path, std::move(settings)), worker_(files_, drawn_) {}

  /// Within about `ms` it puts what the worker thread has
  /// read into the model and onto the GPU, or draws one view of a visibility pass (where levels are chosen by
  /// dB). The worker chooses and reads what the views need. While the views move, the second half of them is
  /// measured where they will be by the time that levels are read. Once the views rest and the model has what
  /// they need, one call takes longer than `ms`: it calibrates what levels lose. The views are those of one
  /// frame, in the model's frame of reference. It uses the settings `quality` and what Visibility::measure()
  /// uses. Returns whether the model has changed. Throws what the worker threw, which then reads nothing
  /// more.
  bool begin_frame(std::span<const shared::View> views, const render::FrameSettings& settings, double ms);
  /// Compiles the shaders that begin_frame() needs for such views, by drawing what it would draw. The model
  /// stays as it is.
  void prepare(std::span<const shared::View> views, const render::FrameSettings& settings);
  /// Whether the model has what the views of the last begin_frame() need, and nothing is to be measured
  /// again.
  bool settled() const;

  /// The calibrated prediction of the views' PSNR against the finest levels, in dB, with the levels that the
  /// model has now. It is of the views that were measured last, and changes from those where the eyes were to
  /// those ahead as time goes by. None where levels are not chosen by dB, or nothing was measured yet.
  std::optional<double> reported_db() const;

 private:
  bool put_some(double ms);
  void calibrate_at_rest(const render::FrameSettings& settings);
  bool pass_is_due() const;
  void make_pass(const render::FrameSettings& settings);
  void request(StreamWorker::Request request);
  bool has_all() const;
  bool needs_another_pass() const;
  double lost_now() const;

  struct Pass {
    std::vector<shared::View> views;  // measured so far: first those where the eyes are, then those ahead
    std::size_t here = 0, all = 0;    // how many views of the first kind, and in all, the pass measures
    VisibleChunks visible;            // what `views` show
    Clock::time_point began = {};
    bool is_outdated = false;  // the model has changed since
  };
  HeadMotion motion_;
  Pass pass_;                   // the last one, or that under way
  int passes_ = 0;              // whole passes at views_
  bool is_due_ = false;         // whether a request for views_ is still to be made
  bool is_calibrated_ = false;  // for views_
  bool made_pass_ = false;      // whether the last frame drew a view of a pass
  double could_put_ = 0.0;      // Gaussians that there was time to put into the model since the last request
  double put_a_ms_ = 1 << 14;   // Gaussians put in a millisecond, as the last frames show
  StreamWorker worker_;
};

/// The most that begin_frame() is given of a frame.
inline constexpr double levels_ms_most = 6.0;

/// The ms for begin_frame() where frames are due every `frame_ms` and drawing takes `drawn_ms`: 2.5 at least,
/// or a head would wait for levels forever, and levels_ms_most at most.
double time_for_levels(double frame_ms, double drawn_ms);

}  // namespace binosplat
