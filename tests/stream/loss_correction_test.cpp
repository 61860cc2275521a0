// The loss of levels, estimated from a sample of chunks.

#include "stream/loss_correction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "scene/reduce.h"
#include "support/models.h"

namespace binosplat {
namespace {

/// Returns a choice for `parts` chunks of two levels. The coarser level's error grows by one from chunk to
/// chunk, in a view of 10 pixels.
LevelChoice choice_of(std::size_t parts) {
  LevelChoice choice;
  choice.pixels = {10.0};
  choice.sphere_pixels = 1000.0;
  choice.first = {0};
  for (std::size_t p = 0; p < parts; ++p) {
    choice.levels.push_back(1);
    for (const double error : {0.0, static_cast<double>(p), 0.0, 0.0}) choice.errors.push_back(error);
    choice.first.push_back(choice.errors.size());
  }
  return choice;
}

TEST(Sample, FavoursLargerLosses) {
  const LevelChoice choice = choice_of(10);
  std::vector<std::size_t> levels = choice.levels;
  levels[9] = 0;
  std::vector<int> times(10, 0);
  constexpr unsigned samples = 4000;
  double roots = 0.0;
  for (int p = 1; p < 9; ++p) roots += std::sqrt(p);
  for (unsigned seed = 0; seed < samples; ++seed) {
    const auto parts = sample_of(choice, levels, 1, seed);
    ASSERT_EQ(parts.size(), 1u);
    ++times[parts[0]];
  }
  EXPECT_EQ(times[0], 0) << "it is predicted to lose nothing";
  EXPECT_EQ(times[9], 0) << "it is at its finest";
  for (int p = 1; p < 9; ++p) {
    const double expected = samples * std::sqrt(p) / roots;
    EXPECT_NEAR(times[static_cast<std::size_t>(p)], expected, 5.0 * std::sqrt(expected)) << p;
  }
  const auto all = sample_of(choice, levels, 100, 1);
  EXPECT_EQ(std::set(all.begin(), all.end()), (std::set<std::size_t>{0, 1, 2, 3, 4, 5, 6, 7, 8}));
  const auto most = sample_of(choice, levels, 8, 1);
  EXPECT_EQ(std::ranges::count(most, 0u), 0) << "what is predicted to lose nothing comes last";
  EXPECT_EQ(sample_of(choice, levels, 3, 5), sample_of(choice, levels, 3, 5));
  EXPECT_NE(sample_of(choice, levels, 3, 5), sample_of(choice, levels, 3, 6));
}

TEST(Sample, SwapsWithDrawnChunks) {
  Model model = without_gaussians(test::random_model(1, 1, 1));
  ModelChunks chunks(4);
  for (std::size_t c = 0; c < 4; ++c)
    chunks.replace(model, c, test::random_model(static_cast<unsigned>(c), 70, 1));
  const ChunkModels finest{{2, 0}, {test::random_model(9, 300, 1), test::random_model(10, 100, 1)}};
  const Model second = chunks.chunk(model, 2);
  const ChunkModels before = swap_chunks(finest, model, chunks);
  EXPECT_EQ(chunks.gaussians(), 540u);
  EXPECT_EQ(chunks.chunk(model, 2).position, finest.models[0].position);
  EXPECT_EQ(before.models[0].position, second.position);
  swap_chunks(before, model, chunks);
  EXPECT_EQ(chunks.chunk(model, 2).sh, second.sh);
  EXPECT_EQ(chunks.gaussians(), 280u);
}

TEST(Sample, IsLimitedByMemory) {
  Model model = without_gaussians(test::random_model(1, 1, 1));
  ModelChunks chunks(2);
  model.capacity = 2 * ModelChunks::block + 100 + 300;
  chunks.replace(model, 0, test::random_model(1, 100, 1));
  ChunkModels finest{{0, 1}, {test::random_model(2, 200, 1), test::random_model(3, 101, 1)}};
  drop_beyond_capacity(finest, model, chunks);
  EXPECT_EQ(finest.chunks, (std::vector<std::size_t>{0}));
  EXPECT_EQ(finest.models.size(), 1u);
  model.capacity += 2;
  finest = {{0, 1}, {test::random_model(2, 200, 1), test::random_model(3, 101, 1)}};
  drop_beyond_capacity(finest, model, chunks);
  EXPECT_EQ(finest.chunks.size(), 2u) << "injected: one less";
}

TEST(SampleError, AddsPredictedLossesOfChunks) {
  const LevelChoice choice = choice_of(4);
  const std::vector<std::size_t> levels = {1, 1, 0, 1}, sample = {1, 2, 3};
  const SampleError error = sample_error(choice, levels, sample, 0.7);
  EXPECT_DOUBLE_EQ(error.predicted, 0.4);
  EXPECT_DOUBLE_EQ(error.all, 0.4);
  EXPECT_EQ(error.measured, 0.7);
  EXPECT_EQ(error.chunks, 3u);
}

TEST(LossCorrection, FullSamplesSetFactor) {
  LossCorrection correction;
  EXPECT_EQ(correction.factor(), 1.0) << "as predicted";
  correction.add({});
  correction.add({.predicted = 0.0, .measured = 1.0, .all = 1.0, .chunks = 8});
  correction.add({.predicted = NAN, .measured = 1.0, .all = 1.0, .chunks = 8});
  EXPECT_EQ(correction.factor(), 1.0) << "nothing is said";
  correction.add({.predicted = 1e-4, .measured = 3e-4, .all = 1e-4, .chunks = 8});
  EXPECT_DOUBLE_EQ(correction.factor(), 3.0) << "that is known, whatever was thought before";
  correction.add({.predicted = 1e-5, .measured = 2e-5, .all = 1e-5, .chunks = 1});
  EXPECT_DOUBLE_EQ(correction.factor(), 2.0) << "injected: more parts had been found to lose something else";
  correction.add({.predicted = 8e-8, .measured = 8e-4, .all = 8e-8, .chunks = 8});
  EXPECT_NEAR(correction.factor(), 1e4, 1e-6) << "injected: 8 times at most, 31 dB less than was told";
  correction.add({.predicted = 1e-4, .measured = 1e-7, .all = 1e-4, .chunks = 8});
  EXPECT_NEAR(correction.factor(), 1e-3, 1e-9);
  EXPECT_EQ(correction.factor_for_choice(), 0.125);
}

// Samples of a few chunks may be far off.
TEST(LossCorrection, PartialSamplesAverage) {
  LossCorrection correction;
  for (int k = 0; k < 200; ++k)
    correction.add({.predicted = 5e-5, .measured = 2.5e-5, .all = 1e-4, .chunks = 8});
  EXPECT_NEAR(10.0 * std::log10(correction.factor()), -3.0 + 0.4, 0.1)
      << "what was thought first is forgotten";
  correction.add({.predicted = 5e-9, .measured = 5e-4, .all = 1e-8, .chunks = 8});
  EXPECT_GT(correction.factor(), 0.55) << "it counts";
  EXPECT_LT(correction.factor(), 2.0) << "injected: as 100,000 times what was predicted";
}

// 0.8 dB, as in pictures of the city and of taebak.
TEST(LossCorrection, AddsJointLoss) {
  LossCorrection correction;
  for (int k = 0; k < 200; ++k)
    correction.add({.predicted = 1e-7, .measured = 1e-7, .all = 1e-4, .chunks = 8});
  EXPECT_NEAR(10.0 * std::log10(correction.factor()), 0.8, 0.1);
}

}  // namespace
}  // namespace binosplat
