#pragma once
// Measures the true loss of levels of detail in a view, with a sample of chunks at their finest levels.
// Predictions are made for each chunk alone and are right in the mean of a scene; one view may lose more or
// less.

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "scene/model.h"
#include "scene/model_chunks.h"
#include "stream/choice.h"

namespace binosplat {

/// Largest sample for which a model keeps room (LodFiles::extra_room).
inline constexpr std::size_t sample_room = 24;

/// Draws up to `most` random chunks that are not at their finest level. A chunk's likelihood grows with the
/// root of its predicted error in the first view. Chunks with a predicted error of 0 come last, in case the
/// prediction is wrong. The same seed draws the same chunks.
std::vector<std::size_t> sample_of(const LevelChoice& choice, std::span<const std::size_t> levels,
                                   std::size_t most, unsigned seed);

/// Some chunks, each once, and their Gaussians.
struct ChunkModels {
  std::vector<std::size_t> chunks;
  std::vector<Model> models;
};

/// Drops the last chunks of `others` for which the model's `room` may be too small.
void drop_beyond_room(ChunkModels& others, const Model& model, const ModelChunks& chunks);

/// Replaces these chunks of the model by `others`, and returns their former Gaussians.
ChunkModels swap_chunks(const ChunkModels& others, Model& model, ModelChunks& chunks);

/// The error of a sample of chunks in a view: squared, mean over pixels and channels.
struct SampleError {
  double predicted = 0.0, measured = 0.0;
  double all = 0.0;        // predicted error of all chunks
  std::size_t chunks = 0;  // in the sample
};

/// Returns the error of a sample in the first view of a choice, with all chunks at `levels`.
SampleError sample_error(const LevelChoice& choice, std::span<const std::size_t> levels,
                         std::span<const std::size_t> sample, double measured);

/// The calibration factor: the ratio of the measured to the predicted error of levels. It is a mean over
/// samples with fading weights. A sample that covers 99 % of the predicted error replaces it.
class LevelCalibration {
 public:
  void add(const SampleError& error);
  double factor() const { return measured_ / chunks_; }
  /// The factor for choosing levels, at least 1/8. Otherwise a sample with hardly any error would allow
  /// levels so coarse that the next sample refutes them.
  double factor_for_choice() const { return std::max(factor(), 1.0 / 8.0); }

 private:
  static constexpr double prior = 8.0;  // chunks that initially count as measured to be as predicted

  // Sum of the samples' weights, in chunks, and sum of weight times measured over predicted error.
  double chunks_ = prior, measured_ = prior;
};

}  // namespace binosplat
