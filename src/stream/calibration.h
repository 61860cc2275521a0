#pragma once
// What levels of detail truly lose in a view, measured with a sample of chunks at their finest levels. The
// prediction has been made for each chunk by itself and is right in the mean of a scene; one view may lose
// more or less.

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "scene/model.h"
#include "scene/model_chunks.h"
#include "stream/choice.h"

namespace binosplat {

/// The chunks of a sample for which a model keeps room (LodFiles::spare).
inline constexpr std::size_t sample_room = 24;

/// Draws up to `most` chunks that are not at their finest level. The likelihood of each grows with the root
/// of the error that it is predicted to cause in the first view. Chunks that are predicted to cause none come
/// last; they are drawn, too, since that may be wrong. The same seed draws the same chunks.
std::vector<std::size_t> sample_of(const LevelChoice& choice, std::span<const std::size_t> levels,
                                   std::size_t most, unsigned seed);

/// Some chunks, each named once, and the Gaussians of each.
struct ChunkModels {
  std::vector<std::size_t> chunks;
  std::vector<Model> models;
};

/// Leaves out the last chunks of `others` for which the model's `room` may be too small.
void keep_what_fits(ChunkModels& others, const Model& model, const ModelChunks& chunks);

/// Puts `others` into the model in the place of the same chunks, and returns the Gaussians that were there.
ChunkModels exchange(const ChunkModels& others, Model& model, ModelChunks& chunks);

/// The error that the chunks of a sample cause in a view: squared, meaned over pixels and channels.
struct SampleError {
  double predicted = 0.0, measured = 0.0;
  double all = 0.0;        // what all chunks are predicted to cause
  std::size_t chunks = 0;  // how many are in the sample
};

/// The error of a sample in the first view of a choice, where all chunks have `levels`.
SampleError sample_error(const LevelChoice& choice, std::span<const std::size_t> levels,
                         std::span<const std::size_t> sample, double measured);

/// The calibration factor: the measured error of levels over the predicted one. It is a mean over samples, in
/// which earlier ones fade; a sample with all chunks that lose anything replaces it.
class LevelCalibration {
 public:
  void add(const SampleError& error);
  double factor() const { return measured_ / chunks_; }
  /// The same, but at least 1/8, for choosing levels: a sample that shows hardly any error allows levels so
  /// coarse that the next sample would show them to be wrong.
  double to_choose_by() const { return std::max(factor(), 1.0 / 8.0); }

 private:
  static constexpr double prior = 8.0;  // chunks that count as measured to be as predicted, at first

  // The sum of the samples' weights, in chunks, and the sum of weight times measured over predicted error.
  double chunks_ = prior, measured_ = prior;
};

}  // namespace binosplat
