#include "stream/level_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/details.h"

namespace binosplat {
namespace {

// Returns boxes of size 1 along x, each with levels of 400, 100 and 25 Gaussians.
std::vector<LodChunk> row_of_chunks(int count) {
  std::vector<LodChunk> chunks;
  for (int i = 0; i < count; ++i)
    chunks.push_back({{2.0 * i, 0, 0}, {2.0 * i + 1, 1, 1}, {{0, 400}, {1, 100}, {2, 25}}});
  return chunks;
}

TEST(Choice, NearChunksComeFirst) {
  const std::vector<LodChunk> chunks = row_of_chunks(6);
  const std::vector<std::size_t> chosen = choose_by_spacing(chunks, {{-1, 0.5, 0.5}}, 899);
  EXPECT_EQ(chosen, (std::vector<std::size_t>{0, 1, 1, 1, 1, 2}));
  // Eyes at the other end, and at both ends with one choice.
  EXPECT_EQ(choose_by_spacing(chunks, {{12, 0.5, 0.5}}, 899), (std::vector<std::size_t>{2, 1, 1, 1, 1, 0}));
  EXPECT_EQ(choose_by_spacing(chunks, {{-1, 0.5, 0.5}, {12, 0.5, 0.5}}, 1250),
            (std::vector<std::size_t>{0, 1, 1, 1, 1, 0}));
}

TEST(Choice, KeepsBudget) {
  const std::vector<LodChunk> chunks = row_of_chunks(6);
  for (std::size_t most = 150; most < 2500; most += 25) {
    const std::size_t used = test::gaussians_of(chunks, choose_by_spacing(chunks, {}, most));
    EXPECT_LE(used, most);
    EXPECT_GE(used + 300, std::min<std::size_t>(most, 2400)) << "room for one more step is left";
  }
  EXPECT_EQ(choose_by_spacing(chunks, {}, 2400), std::vector<std::size_t>(6, 0));
  EXPECT_EQ(choose_by_spacing(chunks, {}, 0), std::vector<std::size_t>(6, 2))
      << "the coarsest are there anyway";
}

/// Returns whether each chunk is as fine as `enough` requires, and no finer.
bool as_needed(const std::vector<LodChunk>& chunks, const std::vector<std::size_t>& chosen,
               const glm::dvec3& eye, double enough) {
  for (std::size_t p = 0; p < chunks.size(); ++p) {
    const double distance = glm::distance(eye, glm::clamp(eye, chunks[p].low, chunks[p].high));
    const auto apart = [&](std::size_t level) {
      return std::sqrt(3.0 / static_cast<double>(chunks[p].levels[level].count)) / distance;
    };
    if (chosen[p] > 0 && apart(chosen[p]) > enough) return false;
    if (chosen[p] + 1 < chunks[p].levels.size() && apart(chosen[p] + 1) <= enough) return false;
  }
  return true;
}

TEST(Choice, StopsAtRequestedSpacing) {
  const std::vector<LodChunk> chunks = row_of_chunks(6);
  const glm::dvec3 eye(-1, 0.5, 0.5);
  std::size_t last = 6 * 400 + 1;
  for (const double enough : {0.005, 0.02, 0.04, 0.08, 0.16, 1.0}) {
    const std::vector<std::size_t> chosen = choose_by_spacing(chunks, {eye}, 10000, enough);
    EXPECT_TRUE(as_needed(chunks, chosen, eye, enough)) << enough;
    EXPECT_LT(test::gaussians_of(chunks, chosen), last) << enough;
    last = test::gaussians_of(chunks, chosen);
  }
  // Injected faults: near chunks get the levels of far ones, and one chunk is too fine.
  std::vector<std::size_t> wrong = choose_by_spacing(chunks, {eye}, 10000, 0.04);
  std::reverse(wrong.begin(), wrong.end());
  EXPECT_FALSE(as_needed(chunks, wrong, eye, 0.04));
  wrong = choose_by_spacing(chunks, {eye}, 10000, 0.04);
  --wrong.back();
  EXPECT_FALSE(as_needed(chunks, wrong, eye, 0.04));
}

TEST(Choice, HasHysteresis) {
  const std::vector<LodChunk> chunks = row_of_chunks(6);
  const auto choose = [&](double x, std::span<const std::size_t> before) {
    return choose_by_spacing(chunks, {{x, 0.5, 0.5}}, 10000, 0.04, before);
  };
  for (double x = -12.0; x < 0.0; x += 0.25) {
    const std::vector<std::size_t> here = choose(x, {});
    // Factors of the distance to the nearest chunk. The other distances change less.
    for (const double by : {0.97, 1.03}) {
      EXPECT_EQ(choose(x * by, here), here) << x << " times " << by;
    }
  }
  const std::vector<std::size_t> far_away = choose(-12.0, {});
  EXPECT_NE(choose(-1.0, far_away), far_away);
  EXPECT_EQ(choose(-12.0, choose(-1.0, {})), far_away);
}

TEST(Choice, HandlesMissingLevels) {
  std::vector<LodChunk> chunks = row_of_chunks(3);
  chunks[0].levels.clear();
  chunks[1].levels = {{1, 100}};
  const std::vector<std::size_t> chosen = choose_by_spacing(chunks, {{0.5, 0.5, 0.5}}, 10000);
  EXPECT_EQ(chosen[1], 0u);
  EXPECT_EQ(test::gaussians_of(chunks, chosen), 500u);
  EXPECT_TRUE(choose_by_spacing({}, {}, 10).empty());
}

TEST(Choice, LevelsAndFramesShareBudget) {
  const double half = levels_target_db(40.0);
  EXPECT_NEAR(error_of_psnr(half), 0.5e-4, 1e-9);
  EXPECT_NEAR(frame_target_db(40.0, half), half, 1e-9);
  EXPECT_NEAR(psnr_of_both(45.0, frame_target_db(40.0, 45.0)), 40.0, 1e-9) << "what levels do not need";
  EXPECT_NEAR(frame_target_db(40.0, 40.0), 50.0, 1e-9) << "a tenth at least";
}

/// Returns a view from x = -1 along x, with a focal length in px.
shared::View view_along_x(float focal) {
  shared::View view = test::view_at({-1, 0.5, 0.5}, focal);
  view.row_x = {0, 0, -1, 0};
  view.row_y = {0, 1, 0, 0};
  view.row_z = {1, 0, 0, 0};
  view.width = view.height = 100;
  return view;
}

// By px, by dB, and the coarsest levels without any view.
TEST(Choice, FollowsRequest) {
  std::vector<LodChunk> chunks = row_of_chunks(6);
  const std::vector<shared::View> views = {view_along_x(100.0f)};
  EXPECT_EQ(choose_levels(chunks, views, {.spacing_px = 4.0}).levels,
            choose_by_spacing(chunks, {{-1, 0.5, 0.5}}, any_number, 0.04));
  EXPECT_NE(choose_levels(chunks, views, {.spacing_px = 4.0}).levels,
            choose_levels(chunks, std::vector{view_along_x(500.0f)}, {.spacing_px = 4.0}).levels)
      << "injected: as if by a shorter lens";
  EXPECT_EQ(choose_levels(chunks, {}, {}).levels, std::vector<std::size_t>(6, 2));
  EXPECT_EQ(choose_levels(chunks, {}, {.db = 40.0}).levels, std::vector<std::size_t>(6, 2));
  for (LodChunk& chunk : chunks) {
    chunk.pixels = {0.01};
    chunk.seen.assign(detail_directions, 1000.0);
    for (LodChunk::Level& level : chunk.levels) level.errors.assign(detail_directions, level.number);
  }
  const LevelChoice choice = choose_levels(chunks, views, {.db = 30.0});
  EXPECT_LE(choice.error(), error_of_psnr(30.0));
  EXPECT_LE(choose_levels(chunks, views, {.db = 30.0, .loss_correction = 8.0}).error(),
            error_of_psnr(30.0) / 8.0);
  EXPECT_GT(choice.error(), error_of_psnr(30.0) / 8.0) << "injected: not calibrated";
}

}  // namespace
}  // namespace binosplat
