#pragma once
// What levels of detail truly lose, measured with a sample of chunks at their finest levels: what is
// predicted is known of each chunk by itself, and in the mean of a scene, but not of what a view shows of it.

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "scene/model.h"
#include "scene/model_chunks.h"
#include "stream/choice.h"

namespace binosplat {

/// Chunks that room is kept for (LodFiles::spare).
inline constexpr std::size_t sample_room = 24;

/// So many chunks, or fewer, that are not at their finest level, each as likely as the root of what the first
/// view is predicted to lose by it is large; those that are predicted to lose nothing come last, since that
/// may be wrong, too. The same seed draws the same chunks.
std::vector<std::size_t> sample_of(const LevelChoice& choice, std::span<const std::size_t> levels,
                                   std::size_t most, unsigned seed);

/// The Gaussians of some chunks, each another one.
struct ChunkModels {
  std::vector<std::size_t> chunks;
  std::vector<Model> models;
};

/// Leaves out what a model's `room` may be too small for.
void keep_what_fits(ChunkModels& others, const Model& model, const ModelChunks& chunks);

/// Puts others in the place of chunks of a model, and returns those that were there.
ChunkModels exchange(const ChunkModels& others, Model& model, ModelChunks& chunks);

/// What a view loses by a sample of chunks: squared, meaned over pixels and channels.
struct SampleError {
  double predicted = 0.0, measured = 0.0;
  double all = 0.0;        // that all chunks are predicted to lose
  std::size_t chunks = 0;  // of the sample
};

/// By the first view of a choice, with these levels of all chunks.
SampleError sample_error(const LevelChoice& choice, std::span<const std::size_t> levels,
                         std::span<const std::size_t> sample, double measured);

/// What levels are measured to lose, as a multiple of what is predicted: what was measured first counts less
/// and less, and nothing once all that is lost was in a sample.
class Calibration {
 public:
  void add(const SampleError& error);
  double factor() const { return measured_ / chunks_; }
  /// The same, but levels that seem to lose nothing are not made as coarse as that allows: a sample of other
  /// chunks would show them to be wrong.
  double to_choose_by() const { return std::max(factor(), 1.0 / 8.0); }

 private:
  static constexpr double prior = 8.0;  // chunks of which nothing is known but what is predicted

  double chunks_ = prior, measured_ = prior;  // and times what is predicted, with what was measured before
};

}  // namespace binosplat
