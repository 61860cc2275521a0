#pragma once
// A model whose levels of detail follow what is seen of it.

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
  DetailRequest detail;  // `most` and `calibration` are the stream's
  /// Levels may lose half of the squared error that FrameSettings::quality allows, and go by dB then.
  bool shares = false;
  /// Where levels would be chosen by dB and the finest have at most so many Gaussians, which fit, all are
  /// drawn.
  std::size_t all_up_to = 0;
  /// Gaussians that there may be beside a frame of these views (none: of a usual pair), with harmonics of a
  /// degree. Empty: any number.
  std::function<std::size_t(std::span<const shared::View> views, int degree)> room = {};
  /// Gaussians that memory is made ready for at first, so that no frame waits for that: begin_frame() is to
  /// be called.
  std::size_t reserve = 0;
};

/// A streamed SOG: its files, the model at the levels that were read, and that model on the GPU. Whoever
/// draws it calls begin_frame() before each frame, or settle() before each picture, and draws gpu_model().
class Stream {
 public:
  /// Opens the files and reads the coarsest levels. Throws Error as LodFiles does, and for dB of a file that
  /// tells no errors.
  Stream(const std::filesystem::path& path, StreamSettings settings);
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  /// Its axes, anti-aliasing and low-pass may be changed before gpu_model() is called; its Gaussians are the
  /// stream's.
  Model& model() { return model_; }
  const ModelChunks& chunks() const { return chunks_; }
  const LodFiles& files() const { return files_; }

  /// The model on the GPU, in a PRECISION_ of shared/axes.h at first, which is uploaded in the first call;
  /// the context must be current in all that follows, and frames of it must end before the stream.
  std::shared_ptr<render::GpuModel> gpu_model(gl::Context& context, int precision);

  /// For frames that must not wait, a call each: within about so many ms it puts what was read meanwhile into
  /// the model and onto the GPU, or measures what one of the views shows; what the views need is chosen and
  /// read by a thread of its own. While the views move, half of them are measured where they will be by the
  /// time that levels are there; once they rest and all has come, one frame takes longer, and calibrates what
  /// levels lose. The views are those of one frame in the model's frame. Returns whether the model has
  /// changed. Of the settings count quality and those of a visibility pass. Throws what reading threw; then
  /// nothing more is read.
  bool begin_frame(std::span<const shared::View> views, const render::FrameSettings& settings, double ms);
  /// Whether the model has what the views of the last begin_frame() need, and nothing is to be measured
  /// again.
  bool settled() const;

  /// For pictures that may wait: chooses, reads and uploads what the views need, by dB up to eleven times,
  /// with a calibration for these views. By DetailRequest::heads_turn levels go on from those of the views
  /// before; else they are the same whatever was drawn before. Returns whether levels have changed, and calls
  /// `before_change` first if so. Throws Error where a file has become unreadable.
  bool settle(std::span<const shared::View> views, const render::FrameSettings& settings,
              const std::function<void()>& before_change = {});

  /// Gaussians of the model.
  std::size_t gaussians() const { return chunks_.gaussians(); }
  /// PSNR in dB that the views are predicted to have against the finest levels with the levels that the model
  /// has now, by the calibration: of those that were measured last, where they were and ahead of that, by how
  /// long ago it was. None where dB are not gone by, or nothing was measured yet.
  std::optional<double> reported_db() const;
  /// How many dB are left for a frame of so many dB for frame and levels together.
  double quality_left(double together_db) const;

  /// ms that reading and uploading took in settle() since the last call.
  struct Times {
    double read_ms = 0.0, upload_ms = 0.0;
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
  // Of settle():
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
  std::vector<shared::View> views_;  // of the last begin_frame() or settle(),
  double quality_ = 0.0;             // and FrameSettings::quality

  // Of begin_frame():
  struct Pass {
    std::vector<shared::View> views;  // that were measured, here first, and those ahead,
    std::size_t here = 0, all = 0;    // of so many;
    VisibleChunks visible;            // by them
    Clock::time_point began = {};
    bool is_outdated = false;  // the model has changed since
  };
  HeadMotion motion_;
  Pass pass_;                   // the last one, or that under way
  int passes_ = 0;              // at these views, each of all of them
  bool is_due_ = false;         // a request for these views
  bool is_calibrated_ = false;  // for these views
  bool made_pass_ = false;      // in the last frame
  double could_put_ = 0.0;      // Gaussians, since the last request,
  double put_a_ms_ = 1 << 14;   // by the last frames
  std::unique_ptr<StreamWorker> worker_;

  // Of settle():
  Chooser chooser_;
  Calibration calibration_;
  unsigned samples_ = 0;
  double sample_error_ = 0.0;  // that the last one was measured to have
  Times times_;
  StreamWorker::Chosen chosen_;
};

/// Of a frame, for begin_frame().
inline constexpr double levels_ms_most = 6.0;

/// What is left for begin_frame() of a frame that is due after so many ms, where drawing takes so long: 2.5
/// ms at least, or a head would wait for levels forever.
double time_for_levels(double frame_ms, double drawn_ms);

}  // namespace binosplat
