#pragma once
// A model whose levels of detail are chosen by what views see of it: what streams of frames (stream.h) and of
// pictures (picture_stream.h) have in common.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "render/frame.h"
#include "render/gpu_model.h"
#include "scene/model_chunks.h"
#include "stream/calibration.h"
#include "stream/chooser.h"
#include "stream/lod_files.h"
#include "stream/visibility.h"

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
  /// The constructor takes memory for this many Gaussians, so that no frame waits for memory.
  std::size_t reserve = 0;
};

/// A streamed SOG: its files, the model at the levels that were read, and that model on the GPU.
class StreamedModel {
 public:
  StreamedModel(const StreamedModel&) = delete;
  StreamedModel& operator=(const StreamedModel&) = delete;

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

  /// Gaussians of the model.
  std::size_t gaussians() const { return chunks_.gaussians(); }
  /// The dB that a frame itself must keep, so that frame and levels together keep `together_db`.
  double quality_left(double together_db) const;

  /// Since the last call: ms that reading and uploading took in settle(), and the Gaussians that
  /// begin_frame() put into the model.
  struct Times {
    double read_ms = 0.0, upload_ms = 0.0;
    std::size_t put = 0;
  };
  Times take_times() { return std::exchange(times_, {}); }

 protected:
  /// Opens the files and reads the coarsest levels. Throws Error as LodFiles does, and where levels are to be
  /// chosen by dB and the file has no errors of levels.
  StreamedModel(const std::filesystem::path& path, StreamSettings settings);
  ~StreamedModel() = default;

  /// `lost`: what levels lose counts as so many times as much.
  DetailRequest request_for(std::span<const shared::View> views, double lost = 1.0) const;
  std::optional<double> db_for(double quality) const;
  /// Whether these views are, to the bit, those of the last frame or picture.
  bool are_last(std::span<const shared::View> views) const;
  /// Puts what was read into the model.
  void put(std::span<const LodFiles::Piece> pieces);
  /// As if nothing had been read yet but what belongs to every level.
  void start_over();
  /// Reads, and uploads where there is a model on the GPU: whole for single pictures, whose Gaussians lie in
  /// another order each time.
  void bring_to(const LevelChoice& choice);
  VisibleChunks measure(std::span<const shared::View> views, const render::FrameSettings& settings);
  /// Measures what the levels drawn lose in the first view, by a picture with a sample of chunks at their
  /// finest, and puts that into the choice. Returns what both pictures show; of no chunks where there is no
  /// sample.
  VisibleChunks calibrate(std::span<const shared::View> views, const render::FrameSettings& settings,
                          LevelChoice& choice);
  /// The dB of a predicted error.
  double reported(double error, double lost = 1.0) const;

  StreamSettings settings_;
  LodFiles files_;
  Model model_;
  ModelChunks chunks_;
  std::vector<std::size_t> drawn_;  // the chunks' levels in the model
  std::shared_ptr<render::GpuModel> gpu_model_;
  std::optional<Visibility> visibility_;
  std::vector<shared::View> views_;  // of the last frame or picture
  double quality_ = 0.0;             // likewise: FrameSettings::quality
  Chooser chooser_;
  LevelCalibration calibration_;
  unsigned samples_ = 0;
  double sample_error_ = 0.0;  // measured with the last sample
  Times times_;

 private:
  bool shows_all_ = false;
};

}  // namespace binosplat
