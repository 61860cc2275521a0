// What levels lose, by a sample of parts.

#include "stream/calibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/random.h"
#include "scene/reduce.h"
#include "support/models.h"

namespace binosplat {
namespace {

/// So many parts of two levels, of which the coarser loses one more for each part in a view of 10 pixels.
DetailChoice choice_of(std::size_t parts) {
  DetailChoice choice;
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

TEST(LevelSample, HasWhatLosesMoreMoreOften) {
  const DetailChoice choice = choice_of(10);
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

TEST(LevelSample, ChangesPlacesWithWhatIsThere) {
  Model model = without_gaussians(test::random_model(1, 1, 1));
  ModelChunks parts(4);
  for (std::size_t p = 0; p < 4; ++p)
    parts.replace(model, p, test::random_model(static_cast<unsigned>(p), 70, 1));
  parts.take_changes();
  std::vector<std::size_t> uploaded;
  const PartsTrial trial = {.upload =
                                [&](const ModelChunks::Changes& changes) {
                                  EXPECT_FALSE(changes.empty());
                                  uploaded.push_back(parts.gaussians());
                                },
                            .keep = {},
                            .differs = {}};
  const ChunkModels finest{{2, 0}, {test::random_model(9, 300, 1), test::random_model(10, 100, 1)}};
  const Model second = parts.part(model, 2);
  const ChunkModels before = exchange(finest, model, parts, trial);
  EXPECT_EQ(parts.part(model, 2).position, finest.models[0].position);
  EXPECT_EQ(before.models[0].position, second.position);
  exchange(before, model, parts, trial);
  EXPECT_EQ(parts.part(model, 2).sh, second.sh);
  EXPECT_EQ(uploaded, (std::vector<std::size_t>{540, 280}));
}

TEST(LevelSample, HasRoom) {
  Model model = without_gaussians(test::random_model(1, 1, 1));
  ModelChunks parts(2);
  model.room = 2 * ModelChunks::block + 100 + 300;
  parts.replace(model, 0, test::random_model(1, 100, 1));
  ChunkModels finest{{0, 1}, {test::random_model(2, 200, 1), test::random_model(3, 101, 1)}};
  keep_what_fits(finest, model, parts);
  EXPECT_EQ(finest.parts, (std::vector<std::size_t>{0}));
  EXPECT_EQ(finest.models.size(), 1u);
  model.room += 2;
  finest = {{0, 1}, {test::random_model(2, 200, 1), test::random_model(3, 101, 1)}};
  keep_what_fits(finest, model, parts);
  EXPECT_EQ(finest.parts.size(), 2u) << "planted: one less";
}

TEST(LevelSample, IsPredictedToLoseASum) {
  const DetailChoice choice = choice_of(4);
  const std::vector<std::size_t> levels = {1, 1, 0, 1}, sample = {1, 2, 3};
  const SampleLoss loss = loss_of(choice, choice.error_of(levels, 0, 1), levels, sample, 0.7);
  EXPECT_DOUBLE_EQ(loss.predicted, 0.4);
  EXPECT_DOUBLE_EQ(loss.all, 0.4);
  EXPECT_EQ(loss.found, 0.7);
  EXPECT_EQ(loss.parts, 3u);
}

// However many change, and whatever views there are.
TEST(LevelsLost, AreThoseOfTheLevelsFollowed) {
  constexpr std::size_t parts = 40, levels_of_part = 3, views = 2;
  Random random(3);
  auto choice = std::make_shared<DetailChoice>();
  choice->pixels = {10.0, 20.0};
  choice->sphere_pixels = 1000.0;
  choice->first = {0};
  for (std::size_t p = 0; p < parts; ++p) {
    for (std::size_t n = 0; n < (views + 1) * levels_of_part; ++n)
      choice->errors.push_back(n % levels_of_part == 0 ? 0.0 : random.uniform(0.0, 1.0));
    choice->first.push_back(choice->errors.size());
  }
  std::vector<std::size_t> levels(parts, 2);
  LevelsLost lost(choice, levels);
  const double at_first = lost.error(0, views);
  for (std::size_t n = 0; n < 200; ++n) {
    levels[n * 7 % parts] = n / 3 % levels_of_part;
    if (n % 4 != 0) continue;
    lost.follow(levels);
    for (std::size_t v = 0; v < views; ++v)
      EXPECT_NEAR(lost.error(v, v + 1), choice->error_of(levels, v, v + 1), 1e-12);
    EXPECT_NEAR(lost.error(0, views), choice->error_of(levels, 0, views), 1e-12);
  }
  EXPECT_GT(std::abs(lost.error(0, views) - at_first), 0.01) << "planted: what it began with";
  lost.follow(std::vector<std::size_t>(parts, 0));
  EXPECT_GE(lost.error(0, views), 0.0);
  EXPECT_NEAR(lost.error(0, views), 0.0, 1e-12);
}

TEST(LevelsFound, AreWhatSamplesOfAllLose) {
  LevelsFound found;
  EXPECT_EQ(found.factor(), 1.0) << "as predicted";
  found.note({});
  found.note({.predicted = 0.0, .found = 1.0, .all = 1.0, .parts = 8});
  found.note({.predicted = NAN, .found = 1.0, .all = 1.0, .parts = 8});
  EXPECT_EQ(found.factor(), 1.0) << "nothing is said";
  found.note({.predicted = 1e-4, .found = 3e-4, .all = 1e-4, .parts = 8});
  EXPECT_DOUBLE_EQ(found.factor(), 3.0) << "that is known, whatever was thought before";
  found.note({.predicted = 1e-5, .found = 2e-5, .all = 1e-5, .parts = 1});
  EXPECT_DOUBLE_EQ(found.factor(), 2.0) << "planted: more parts had been found to lose something else";
  found.note({.predicted = 8e-8, .found = 8e-4, .all = 8e-8, .parts = 8});
  EXPECT_NEAR(found.factor(), 1e4, 1e-6) << "planted: 8 times at most, 31 dB less than was told";
  found.note({.predicted = 1e-4, .found = 1e-7, .all = 1e-4, .parts = 8});
  EXPECT_NEAR(found.factor(), 1e-3, 1e-9);
  EXPECT_EQ(found.to_choose_by(), 0.125);
}

// One of some parts may be far off.
TEST(LevelsFound, AreWhatSamplesOfSomeLose) {
  LevelsFound found;
  for (int k = 0; k < 200; ++k) found.note({.predicted = 5e-5, .found = 2.5e-5, .all = 1e-4, .parts = 8});
  EXPECT_NEAR(10.0 * std::log10(found.factor()), -3.0 + 0.4, 0.1) << "what was thought first is forgotten";
  found.note({.predicted = 5e-9, .found = 5e-4, .all = 1e-8, .parts = 8});
  EXPECT_GT(found.factor(), 0.55) << "it counts";
  EXPECT_LT(found.factor(), 2.0) << "planted: as 100,000 times what was predicted";
}

// 0.8 dB, as pictures of the city and of taebak have it.
TEST(LevelsFound, PartsLoseMoreTogether) {
  LevelsFound found;
  for (int k = 0; k < 200; ++k) found.note({.predicted = 1e-7, .found = 1e-7, .all = 1e-4, .parts = 8});
  EXPECT_NEAR(10.0 * std::log10(found.factor()), 0.8, 0.1);
}

}  // namespace
}  // namespace binosplat
