#pragma once
// A model whose levels of detail are chosen by what views see of it.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "render/frame.h"
#include "render/gpu_model.h"
#include "scene/model_chunks.h"
#include "stream/calibration.h"
#include "stream/chooser.h"
#include "stream/head_motion.h"
#include "stream/lod_files.h"
#include "stream/visibility.h"
#include "stream/worker.h"

namespace binosplat {

struct StreamSettings {
  DetailRequest detail;  // the stream sets `calibration`, and lowers `most` to what `room` says
  /// With FrameSettings::quality, levels are chosen by dB and may lose half of the squared error that it
  /// allows.
  bool shares = false;
  /// Where levels would be chosen by dB, a model whose finest levels have at most this many Gaussians, and
  /// fit, is drawn at these.
  std::size_t all_up_to = 0;
  /// Returns how many Gaussians with harmonics of a degree fit beside a frame of these views (no views: a
  /// usual pair). Empty: any number fits.
  std::function<std::size_t(std::span<const shared::View> views, int degree)> room = {};
  /// The constructor takes memory for this many Gaussians, so that no begin_frame() waits for memory. 0 where
  /// only settle() is called.
  std::size_t reserve = 0;
};

/// A streamed SOG: its files, the model at the levels that were read, and that model on the GPU. Whoever
/// draws it calls begin_frame() before each frame, or settle() before each picture, and draws gpu_model().
class Stream {
 public:
  /// Opens the files and reads the coarsest levels. Throws Error as LodFiles does, and where levels are to be
  /// chosen by dB and the file has no errors of levels.
  Stream(const std::filesystem::path& path, StreamSettings settings);
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  /// Its axes, anti-aliasing and low-pass may be changed before gpu_model() is called; its Gaussians are the
  /// stream's.
  Model& model() { return model_; }
  const ModelChunks& chunks() const { return chunks_; }
  const LodFiles& files() const { return files_; }

  /// The model on the GPU. The first call uploads it, in a PRECISION_ of shared/axes.h; from then on the
  /// context must be current in every call. Frames that draw it must be destroyed before the stream.
  std::shared_ptr<render::GpuModel> gpu_model(gl::Context& context, int precision);

  /// Frees what gpu_model() uploaded: no frame draws it any more. Another context may follow.
  void release_gpu_model() {
    visibility_.reset();
    gpu_model_.reset();
  }

  /// To be called before each frame that must not wait. Within about `ms` it puts what the worker thread has
  /// read into the model and onto the GPU, or draws one view of a visibility pass (where levels are chosen by
  /// dB). The worker chooses and reads what the views need. While the views move, the second half of them is
  /// measured where they will be by the time that levels are read. Once the views rest and the model has what
  /// they need, one call takes longer than `ms`: it calibrates what levels lose. The views are those of one
  /// frame, in the model's frame of reference. It uses the settings `quality` and what Visibility::measure()
  /// uses. Returns whether the model has changed. Throws what the worker threw, which then reads nothing
  /// more.
  bool begin_frame(std::span<const shared::View> views, const render::FrameSettings& settings, double ms);
  /// Whether the model has what the views of the last begin_frame() need, and nothing is to be measured
  /// again.
  bool settled() const;

  /// For pictures that may wait: chooses, reads and uploads what the views need before it returns; by dB up
  /// to eleven times, with a calibration for these views. With DetailRequest::heads_turn the choice starts
  /// from the levels of the views before; without, it does not depend on them. Returns whether levels have
  /// changed; calls `before_change` before they do. Throws Error where a file has become unreadable.
  bool settle(std::span<const shared::View> views, const render::FrameSettings& settings,
              const std::function<void()>& before_change = {});

  /// Gaussians of the model.
  std::size_t gaussians() const { return chunks_.gaussians(); }
  /// The calibrated prediction of the views' PSNR against the finest levels, in dB, with the levels that the
  /// model has now. It is of the views that were measured last, and changes from those where the eyes were to
  /// those ahead as time goes by. None where levels are not chosen by dB, or nothing was measured yet.
  std::optional<double> reported_db() const;
  /// The dB that a frame itself must keep, so that frame and levels together keep `together_db`.
  double quality_left(double together_db) const;

  /// Since the last call: ms that reading and uploading took in settle(), and the Gaussians that
  /// begin_frame() put into the model.
  struct Times {
    double read_ms = 0.0, upload_ms = 0.0;
    std::size_t put = 0;
  };
  Times take_times() { return std::exchange(times_, {}); }

 private:
  DetailRequest request_for(std::span<const shared::View> views) const;
  std::optional<double> db_for(double quality) const;
  /// Whether these views are, to the bit, those of the last begin_frame() or settle().
  bool are_last(std::span<const shared::View> views) const;
  void put(std::span<const LodFiles::Piece> pieces);
  bool put_some(double ms);
  void calibrate_at_rest(const render::FrameSettings& settings);
  bool pass_is_due() const;
  void make_pass(const render::FrameSettings& settings);
  void request(StreamWorker::Request request);
  bool has_all() const;
  bool needs_another_pass() const;
  double reported(double error) const;
  double elsewhere() const;
  // Used by settle():
  void start_over();
  void bring_to(const LevelChoice& choice);
  VisibleChunks measure(std::span<const shared::View> views, const render::FrameSettings& settings);
  VisibleChunks calibrate(std::span<const shared::View> views, const render::FrameSettings& settings,
                          LevelChoice& choice);

  StreamSettings settings_;
  LodFiles files_;
  Model model_;
  ModelChunks chunks_;
  std::vector<std::size_t> drawn_;  // the chunks' levels in the model
  bool shows_all_ = false;
  std::shared_ptr<render::GpuModel> gpu_model_;
  std::optional<Visibility> visibility_;
  std::vector<shared::View> views_;  // the arguments of the last begin_frame() or settle()
  double quality_ = 0.0;             // likewise: FrameSettings::quality

  // Used by begin_frame():
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
  std::unique_ptr<StreamWorker> worker_;

  // Used by settle():
  Chooser chooser_;
  LevelCalibration calibration_;
  unsigned samples_ = 0;
  double sample_error_ = 0.0;  // measured with the last sample
  Times times_;
  StreamWorker::Chosen chosen_;
};

/// The most that begin_frame() is given of a frame.
inline constexpr double levels_ms_most = 6.0;

/// The ms for begin_frame() where frames are due every `frame_ms` and drawing takes `drawn_ms`: 2.5 at least,
/// or a head would wait for levels forever, and levels_ms_most at most.
double time_for_levels(double frame_ms, double drawn_ms);

}  // namespace binosplat
