#pragma once
// Measures how much a view really loses by its levels of detail: draws a sample of chunks at their finest
// levels. The predicted loss sums the losses of single chunks, which is right only on average over a scene.

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "scene/model.h"
#include "scene/model_chunks.h"
#include "stream/level_choice.h"

namespace binosplat {

/// A model keeps room for samples of up to this many chunks (LodFiles::extra_capacity).
inline constexpr std::size_t sampled_chunks = 24;

/// Picks up to `most` random chunks that are not at their finest level. A chunk's likelihood grows with the
/// root of its predicted error in the first view. Chunks with a predicted error of 0 are picked last, in case
/// the prediction is wrong. The same seed picks the same chunks.
std::vector<std::size_t> sample_of(const LevelChoice& choice, std::span<const std::size_t> levels,
                                   std::size_t most, unsigned seed);

/// Some chunks, each once, and their Gaussians.
struct ChunkModels {
  std::vector<std::size_t> chunks;
  std::vector<Model> models;
};

/// Keeps the first of `others` that surely fit into Model::capacity beside the model's chunks; drops the
/// rest.
void drop_beyond_capacity(ChunkModels& others, const Model& model, const ModelChunks& chunks);

/// Replaces chunks of the model by those of `others`, and returns the replaced Gaussians.
ChunkModels swap_chunks(const ChunkModels& others, Model& model, ModelChunks& chunks);

/// The error of a sample of chunks in a view: squared, mean over pixels and channels.
struct SampleError {
  double predicted = 0.0, measured = 0.0;
  double all = 0.0;        // predicted error of all chunks
  std::size_t chunks = 0;  // number of chunks in the sample
};

/// Returns a sample's error in the first view of a choice: predicted for chunks at `levels`, and `measured`.
SampleError sample_error(const LevelChoice& choice, std::span<const std::size_t> levels,
                         std::span<const std::size_t> sample, double measured);

/// The calibration factor: the measured divided by the predicted error of levels, a mean in which older
/// samples weigh less. A sample that covers 99 % of the predicted error replaces the mean.
class LossCorrection {
 public:
  void add(const SampleError& error);
  double factor() const { return measured_ / chunks_; }
  /// The factor for choosing levels, at least 1/8. Without this limit, a sample with hardly any error would
  /// allow levels so coarse that the next sample refutes them.
  double factor_for_choice() const { return std::max(factor(), 1.0 / 8.0); }

 private:
  static constexpr double prior = 8.0;  // weight, in chunks, of the initial factor 1

  // The sum of the samples' weights, in chunks, and the sum of weight * measured error / predicted error.
  double chunks_ = prior, measured_ = prior;
};

}  // namespace binosplat
