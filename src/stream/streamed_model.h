#pragma once
// A model whose levels of detail are chosen by visibility: the base of Stream and PictureStream.

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
#include "stream/chooser.h"
#include "stream/lod_files.h"
#include "stream/loss_correction.h"
#include "stream/visibility.h"

namespace binosplat {

struct StreamSettings {
  DetailRequest detail;  // the stream sets `loss_correction`, and limits `max_gaussians` by `max_in_memory`
  /// If true, a FrameSettings::quality chooses levels by dB. They may use half of the squared error that the
  /// quality allows; the frame uses the rest.
  bool shares_quality = false;
  /// If the finest levels have at most this many Gaussians and fit into memory, requests in dB have no
  /// effect: levels follow `detail.spacing_px`, whose default selects the finest.
  std::size_t finest_up_to = 0;
  /// Returns how many Gaussians with harmonics of a degree fit into memory together with a frame of these
  /// views; without views, of a typical eye pair. If this function is empty, any number fits.
  std::function<std::size_t(std::span<const shared::View> views, int degree)> max_in_memory = {};
  /// The constructor allocates memory for this many Gaussians, so that no frame waits for an allocation.
  std::size_t reserve = 0;
};

/// A streamed SOG: its files, the model at the present levels, and that model on the GPU.
class StreamedModel {
 public:
  StreamedModel(const StreamedModel&) = delete;
  StreamedModel& operator=(const StreamedModel&) = delete;

  /// The caller may change the axes, anti-aliasing and low-pass before gpu_model(), but never the Gaussians.
  Model& model() { return model_; }
  const ModelChunks& chunks() const { return chunks_; }
  const LodFiles& files() const { return files_; }

  /// Returns the model on the GPU. The first call uploads it; `precision` is a PRECISION_ of
  /// shared/choices.h. From then on the context must be current in every call. Frames that draw the model
  /// must be destroyed before the stream.
  std::shared_ptr<render::GpuModel> gpu_model(gl::Context& context, int precision);

  /// Frees the model on the GPU, which no frame may draw then. The next gpu_model() may use another context.
  void release_gpu_model() {
    visibility_.reset();
    gpu_model_.reset();
  }

  std::size_t gaussians() const { return chunks_.gaussians(); }
  /// Returns the dB that a frame itself must reach, so that frame and levels together reach `together_db`.
  std::optional<float> frame_quality(std::optional<float> together_db) const;

  /// Since the last take_times(): ms of reading and uploading in settle(); Gaussians that begin_frame()
  /// added.
  struct Times {
    double read_ms = 0.0, upload_ms = 0.0;
    std::size_t put = 0;
  };
  Times take_times() { return std::exchange(times_, {}); }

 protected:
  /// Opens the files and reads the coarsest levels. Throws Error as LodFiles does, and if levels are
  /// requested by dB but the file lacks the errors of its levels.
  StreamedModel(const std::filesystem::path& path, StreamSettings settings);
  ~StreamedModel() = default;

  /// `lost` multiplies the predicted loss of levels.
  DetailRequest request_for(std::span<const shared::View> views, double lost = 1.0) const;
  std::optional<double> levels_db_for(std::optional<float> quality) const;
  /// Returns whether the last frame or picture had these views, bit for bit.
  bool equal_last_views(std::span<const shared::View> views) const;
  /// Inserts loaded chunks into the model.
  void put(std::span<const LodFiles::LoadedChunk> loaded_chunks);
  /// Resets the model to the Gaussians that are part of every level.
  void start_over();
  /// Reads a choice's levels. If the model is on the GPU, uploads the changes; for single pictures uploads
  /// the whole model, since start_over() moves most Gaussians.
  void read_levels(const LevelChoice& choice);
  VisibleChunks measure(std::span<const shared::View> views, const render::FrameSettings& settings);
  /// Draws the first view twice, at the drawn levels and with a sample of chunks at their finest levels. The
  /// difference is the loss of the sample's levels. Updates the calibration and the choice. Returns the
  /// chunks' visibility; empty if no chunk is in the sample.
  VisibleChunks calibrate(std::span<const shared::View> views, const render::FrameSettings& settings,
                          LevelChoice& choice);
  /// Returns the calibrated dB of a predicted error.
  double reported(double error, double lost = 1.0) const;

  StreamSettings settings_;
  LodFiles files_;
  Model model_;
  ModelChunks chunks_;
  std::vector<std::size_t> drawn_;  // level of each chunk in the model
  std::shared_ptr<render::GpuModel> gpu_model_;
  std::optional<Visibility> visibility_;
  std::vector<shared::View> views_;  // of the last frame or picture
  std::optional<float> quality_;     // Settings::quality of the last frame or picture
  Chooser chooser_;
  LossCorrection loss_correction_;
  unsigned samples_ = 0;       // number of samples, and the seed of the next one
  double sample_error_ = 0.0;  // error measured with the last sample
  Times times_;

 private:
  bool draws_finest_ = false;
};

}  // namespace binosplat
