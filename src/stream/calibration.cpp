#include "stream/calibration.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "base/random.h"

namespace binosplat {

namespace {

// The loss of chunks together over the sum of their losses alone: neighbouring and overlapping chunks err
// alike. Measured: 0.6 to 1.0 dB in headset pictures of the city, from street and air, and of taebak.
const double together = std::pow(10.0, 0.08);
constexpr double fades = 0.9;      // weight of earlier samples against the next one
constexpr double nothing = 1e-20;  // squared error of a picture
// A sample's ratio of measured to predicted error is limited to this factor and its inverse: single chunks
// vary more.
constexpr double by_chance = 8.0;

}  // namespace

// Weighted sampling by Efraimidis and Spirakis (2006): takes the largest of random numbers to the power of
// one over the weight. The weight is the root of the loss. With the loss itself as weight, chunks of large
// loss would dominate a sample's sum even more. They lose 1.1 times the prediction, while others lose 0.6
// times (city, street).
std::vector<std::size_t> sample_of(const LevelChoice& choice, std::span<const std::size_t> levels,
                                   std::size_t most, unsigned seed) {
  Random random(seed);
  std::vector<std::pair<double, std::size_t>> keys;  // and chunks
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

void drop_beyond_room(ChunkModels& others, const Model& model, const ModelChunks& chunks) {
  std::size_t taken = chunks.gaussians() + chunks.size() * ModelChunks::block, kept = 0;  // half empty blocks
  for (; kept < others.chunks.size(); ++kept) {
    taken += others.models[kept].count();
    if (taken > model.room) break;
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

void LevelCalibration::add(const SampleError& error) {
  if (!(error.predicted > 0.0 && error.all > 0.0)) return;
  const double left = 1.0 - std::min(error.predicted / error.all, 1.0),
               times = error.measured / error.predicted;
  if (left < 0.01) {  // the sample covers nearly all
    chunks_ = static_cast<double>(error.chunks);
    measured_ = chunks_ * times;
    return;
  }
  const double chunks = static_cast<double>(error.chunks) / left;
  chunks_ = fades * chunks_ + chunks;
  measured_ =
      fades * measured_ + chunks * std::clamp(times * std::pow(together, left), 1.0 / by_chance, by_chance);
}

}  // namespace binosplat
