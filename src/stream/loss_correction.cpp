#include "stream/loss_correction.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "base/random.h"

namespace binosplat {

namespace {

// The error of all chunks together, divided by the sum of their single errors: above 1, since neighbouring
// and overlapping chunks err alike. Measured ratios: 0.6 to 1.0 dB, in headset pictures of the city and
// taebak.
const double together = std::pow(10.0, 0.08);
constexpr double decay = 0.9;      // each new sample multiplies the weights of earlier samples by this factor
constexpr double nothing = 1e-20;  // least squared error in a sampling weight, which must not be 0
// A sample's ratio of measured to predicted error is clamped to this factor and its inverse, since the ratios
// of single chunks vary even more.
constexpr double by_chance = 8.0;

}  // namespace

// Weighted sampling by Efraimidis and Spirakis (2006): raises a random number for each chunk to 1/weight, and
// takes the largest results. The weight is the root of the predicted loss, so that chunks of large loss,
// which lose 1.1 times the prediction (others: 0.6 times; city, from the street), dominate the sample less.
std::vector<std::size_t> sample_of(const LevelChoice& choice, std::span<const std::size_t> levels,
                                   std::size_t most, unsigned seed) {
  Random random(seed);
  std::vector<std::pair<double, std::size_t>> keys;  // pairs of key and chunk
  for (std::size_t c = 0; c < levels.size(); ++c) {
    if (levels[c] == 0) continue;
    const double lost = choice.error_of_chunk(0, c, levels[c]);
    keys.emplace_back(std::log(random.uniform(1e-12, 1.0)) / std::sqrt(std::max(lost, nothing)), c);
  }
  const std::size_t count = std::min(keys.size(), most);
  std::ranges::partial_sort(keys, keys.begin() + static_cast<std::ptrdiff_t>(count), std::greater<>());
  std::vector<std::size_t> chunks;
  for (std::size_t k = 0; k < count; ++k) chunks.push_back(keys[k].second);
  return chunks;
}

void drop_beyond_capacity(ChunkModels& others, const Model& model, const ModelChunks& chunks) {
  // Counts one block more for each chunk, because a chunk's last block may be almost empty.
  std::size_t taken = chunks.gaussians() + chunks.size() * ModelChunks::block, kept = 0;
  for (; kept < others.chunks.size(); ++kept) {
    taken += others.models[kept].count();
    if (taken > model.capacity) break;
  }
  others.chunks.resize(kept);
  others.models.resize(kept);
}

ChunkModels swap_chunks(const ChunkModels& others, Model& model, ModelChunks& chunks) {
  ChunkModels before{others.chunks, {}};
  std::vector<ModelChunks::Replacement> replacements;
  for (std::size_t k = 0; k < others.chunks.size(); ++k) {
    before.models.push_back(chunks.chunk(model, others.chunks[k]));
    replacements.push_back({others.chunks[k], &others.models[k]});
  }
  chunks.replace(model, replacements);
  return before;
}

SampleError sample_error(const LevelChoice& choice, std::span<const std::size_t> levels,
                         std::span<const std::size_t> sample, double measured) {
  SampleError error{.measured = measured, .all = choice.error_of_view(0, levels), .chunks = sample.size()};
  for (const std::size_t chunk : sample) error.predicted += choice.error_of_chunk(0, chunk, levels[chunk]);
  return error;
}

void LossCorrection::add(const SampleError& error) {
  if (!(error.predicted > 0.0 && error.all > 0.0)) return;
  const double left = 1.0 - std::min(error.predicted / error.all, 1.0),
               times = error.measured / error.predicted;
  if (left < 0.01) {  // the sample covers nearly all of the error
    chunks_ = static_cast<double>(error.chunks);
    measured_ = chunks_ * times;
    return;
  }
  const double chunks = static_cast<double>(error.chunks) / left;
  chunks_ = decay * chunks_ + chunks;
  measured_ =
      decay * measured_ + chunks * std::clamp(times * std::pow(together, left), 1.0 / by_chance, by_chance);
}

}  // namespace binosplat
