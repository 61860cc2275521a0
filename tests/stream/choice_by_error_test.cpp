// Levels of detail chosen by the error in views.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "base/random.h"
#include "stream/level_choice.h"
#include "support/details.h"

namespace binosplat {
namespace {

using Levels = std::vector<std::size_t>;

constexpr std::size_t any = 1'000'000;  // Gaussians

/// Returns the numbers once for each direction, one after another.
std::vector<double> in_all_directions(const std::vector<double>& by_width) {
  std::vector<double> all;
  for (std::size_t d = 0; d < detail_directions; ++d) all.insert(all.end(), by_width.begin(), by_width.end());
  return all;
}

/// Returns chunks in a row: boxes of size 1 along x, with four levels each. The errors of coarser levels are
/// random.
std::vector<LodChunk> row_with_errors(int count, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> factor(1.5, 6.0);
  std::vector<LodChunk> chunks;
  for (int i = 0; i < count; ++i) {
    LodChunk chunk{{2.0 * i, 0, 0}, {2.0 * i + 1, 1, 1}, {}, {0.01, 0.02, 0.04}};
    chunk.seen = in_all_directions({6000.0, 1600.0, 400.0});
    double error = 0.0;
    for (int level = 0; level < 4; ++level) {
      chunk.levels.push_back(
          {level, std::size_t{400} >> level, in_all_directions({error, 0.3 * error, 0.1 * error})});
      error = factor(random) * std::max(error, 0.2);
    }
    chunks.push_back(std::move(chunk));
  }
  return chunks;
}

/// Returns the inward normals of a square picture that looks along `ahead`, in the xz plane; `slope` is the
/// tangent of half its angle.
std::array<glm::dvec3, 5> inward_of(const glm::dvec3& ahead, double slope) {
  std::array<glm::dvec3, 5> inward = {{{}, {}, {}, {}, ahead}};
  const glm::dvec3 y(0, 1, 0), aside = glm::cross(ahead, y);
  for (std::size_t k = 0; k < 4; ++k)
    inward[k] = glm::normalize(slope * ahead + (k % 2 == 0 ? 1.0 : -1.0) * (k < 2 ? aside : y));
  return inward;
}

DetailView along_x(double x, double forward = 1.0) {
  return {.eye = {x, 0.5, 0.5}, .inward = inward_of({forward, 0, 0}, 1.0), .focal = 100.0, .pixels = 1e4};
}

/// Returns the visibility of a chunk that nothing hides.
ChunkVisibility open_view(const LodChunk& chunk, const DetailView& view) {
  const double distance = std::max(glm::distance(view.eye, glm::clamp(view.eye, chunk.low, chunk.high)),
                                   0.01 * glm::distance(chunk.low, chunk.high));
  const double px = chunk.pixels.front() * view.focal / distance;
  return {chunk.seen.front() * px * px, distance};
}

/// Returns the loss per pixel of an eye that sees the whole row.
double loss(const std::vector<LodChunk>& chunks, const Levels& chosen, const DetailView& view) {
  double sum = 0.0;
  for (std::size_t p = 0; p < chunks.size(); ++p) {
    const ChunkVisibility seen = open_view(chunks[p], view);
    const glm::dvec3 along = 0.5 * (chunks[p].low + chunks[p].high) - view.eye;
    sum += seen.area * relative_error(chunks[p], chosen[p], seen.distance / view.focal, along);
  }
  return sum / view.pixels;
}

/// Returns the fewest Gaussians of all choices within the error.
std::size_t fewest(const std::vector<LodChunk>& chunks, const DetailView& view, double error) {
  std::size_t best = any;
  Levels chosen(chunks.size(), 0);
  for (std::size_t n = 0; n < std::size_t{1} << (2 * chunks.size()); ++n) {
    for (std::size_t p = 0; p < chunks.size(); ++p) chosen[p] = n >> (2 * p) & 3;
    if (test::gaussians_of(chunks, chosen) < best && loss(chunks, chosen, view) <= error)
      best = test::gaussians_of(chunks, chosen);
  }
  return best;
}

TEST(ChoiceByError, InterpolatesErrorsByPixelWidth) {
  LodChunk chunk{{}, {1, 1, 1}, {{0, 9, in_all_directions({0.0, 0.0, 0.0})}}, {0.5, 1.0, 2.0}};
  chunk.seen = in_all_directions({100.0, 25.0, 0.0});
  chunk.levels.push_back({1, 4, in_all_directions({8.0, 1.0, 0.0})});
  for (const auto& [width, error] : {std::pair(0.5, 0.08),
                                     {1.0, 0.04},
                                     {2.0, 0.0},
                                     {std::sqrt(0.5), std::sqrt(0.08 * 0.04)},
                                     {std::sqrt(2.0), 0.04},  // half of the error and of the visible pixels
                                     {0.25, 0.08 * std::pow(2.0, 0.3)},
                                     {1e-9, 0.64},
                                     {4.0, 0.0}}) {
    EXPECT_NEAR(relative_error(chunk, 1, width, {1, 0, 0}), error, 1e-9) << width;
    EXPECT_EQ(relative_error(chunk, 0, width, {1, 0, 0}), 0.0) << width;
  }
  for (const double width : {0.0, 1e300, std::numeric_limits<double>::infinity()})
    EXPECT_TRUE(std::isfinite(relative_error(chunk, 1, width, {0, 0, 1}))) << width;
}

TEST(ChoiceByError, InterpolatesErrorsByDirection) {
  LodChunk chunk{{}, {1, 1, 1}, {{0, 9, {}}}, {0.5}};
  chunk.seen = {1, 2, 3, 4, 5, 6};
  chunk.levels[0].errors = {0.1, 0.1, 0.2, 0.2, 0.3, 0.6};
  for (std::size_t d = 0; d < detail_directions; ++d)
    EXPECT_NEAR(relative_error(chunk, 0, 0.5, 3.0 * detail_direction(d)),
                chunk.levels[0].errors[d] / chunk.seen[d], 1e-12);
  EXPECT_NEAR(relative_error(chunk, 0, 0.5, {1, -1, 0}), (0.1 + 0.2) / (1 + 4), 1e-12);
  EXPECT_NEAR(relative_error(chunk, 0, 0.5, {-2, 0, -1}), (4 * 0.1 + 0.6) / (4 * 2 + 6), 1e-12);
  EXPECT_NEAR(relative_error(chunk, 0, 0.5, {0, 0, 0}), (0.1 + 0.2 + 0.3) / (1 + 3 + 5), 1e-12) << "of none";
}

TEST(ChoiceByError, KeepsBoundWithFewGaussians) {
  double worst = 1.0;
  std::size_t injected = 0, cases = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    const std::vector<LodChunk> chunks = row_with_errors(6, seed);
    const DetailView near = along_x(-1.0), far = along_x(-40.0);
    for (const double error : {1e-5, 1e-4, 3e-4, 1e-3}) {
      const LevelChoice choice = choose_by_error(chunks, {near}, {error, any});
      EXPECT_LE(loss(chunks, choice.levels, near), error);
      EXPECT_NEAR(choice.error(), loss(chunks, choice.levels, near), 1e-12);
      const Levels others(chunks.size(), 2);
      EXPECT_NEAR(choice.error_of(others), loss(chunks, others, near), 1e-9 * choice.error_of(others));
      worst = std::max(worst, static_cast<double>(test::gaussians_of(chunks, choice.levels)) /
                                  static_cast<double>(fewest(chunks, near, error)));
      // Injected faults: levels for another position, and levels that ignore the bound.
      injected += loss(chunks, choose_by_error(chunks, {far}, {error, any}).levels, near) > error;
      injected += loss(chunks, Levels(chunks.size(), 3), near) > error;
      cases += 2;
    }
  }
  EXPECT_LE(worst, 1.25);
  EXPECT_GT(injected, cases * 3 / 4);
}

TEST(ChoiceByError, MoreDecibelsNeedMoreGaussians) {
  const std::vector<LodChunk> chunks = row_with_errors(20);
  std::size_t last = 0;
  for (double db = 20.0; db <= 80.0; db += 1.0) {
    const LevelChoice choice = choose_by_error(chunks, {along_x(-1.0)}, {std::pow(10, -0.1 * db), any});
    EXPECT_GE(test::gaussians_of(chunks, choice.levels), last) << db;
    last = test::gaussians_of(chunks, choice.levels);
  }
  EXPECT_EQ(last, 20u * 400);
}

TEST(ChoiceByError, CoversAllViews) {
  const std::vector<LodChunk> chunks = row_with_errors(8);
  const DetailView first = along_x(-1.0), last = along_x(16.0, -1.0);
  const LevelChoice both = choose_by_error(chunks, {first, last}, {1e-4, any});
  EXPECT_EQ(both.levels, choose_by_error(chunks, {last, first}, {1e-4, any}).levels);
  EXPECT_LE(std::max(loss(chunks, both.levels, first), loss(chunks, both.levels, last)), both.error());
  EXPECT_LE(both.error(), 1e-4);
  EXPECT_GT(loss(chunks, choose_by_error(chunks, {first}, {1e-4, any}).levels, last), 1e-4)
      << "injected: the choice for one";
}

TEST(ChoiceByError, PreparesChunksOutOfSight) {
  const std::vector<LodChunk> chunks = row_with_errors(8);
  const DetailView ahead = along_x(6.5), beside = along_x(-1.0, -1.0);
  const LevelChoice one = choose_by_error(chunks, {ahead}, {1e-4, any});
  EXPECT_LE(one.error(), 1e-4);
  EXPECT_LT(one.levels[2], 3u) << "behind";
  // Only its visible part counts as error.
  EXPECT_LT(one.error(), loss(chunks, one.levels, ahead));
  // A view that sees no chunk has the levels that the sphere around it requires: not the coarsest, and not
  // the finest.
  const LevelChoice nothing = choose_by_error(chunks, {beside}, {1e-4, any});
  EXPECT_EQ(nothing.error(), 0.0);
  EXPECT_LT(nothing.levels.front(), 3u);
  EXPECT_LT(test::gaussians_of(chunks, nothing.levels),
            test::gaussians_of(chunks, choose_by_error(chunks, {along_x(-1.0)}, {1e-4, any}).levels));
  // A single picture does not need the sphere. Its visible chunks have the same levels.
  const LevelChoice still = choose_by_error(chunks, {ahead}, {1e-4, any, false});
  EXPECT_EQ(still.levels[2], 3u);
  EXPECT_EQ(still.levels[7], one.levels[7]);
  EXPECT_LE(still.error(), 1e-4);
  EXPECT_EQ(choose_by_error(chunks, {beside}, {1e-4, any, false}).levels, Levels(chunks.size(), 3));
  // A chunk beside the picture is visible if its coarsest Gaussians extend into the picture.
  const std::vector<LodChunk> at_edge = {row_with_errors(1).front()};
  DetailView view{.eye = {0.5, 0.5, -2.0},
                  .inward = inward_of({std::sin(0.79), 0, std::cos(0.79)}, 0.5),
                  .focal = 100.0,
                  .pixels = 1.0};
  EXPECT_GT(choose_by_error(at_edge, {view}, {1e9, any}).error(), 0.0);
  VisibleChunks seen{{{ChunkVisibility{}}}, {3}};
  EXPECT_EQ(choose_by_error(at_edge, {view}, {1e9, any}, seen).error(), 0.0) << "they were drawn, and do not";
  seen.drawn = {1};
  EXPECT_GT(choose_by_error(at_edge, {view}, {1e9, any}, seen).error(), 0.0) << "finer ones were";
  view.inward = inward_of({std::sin(0.83), 0, std::cos(0.83)}, 0.5);
  EXPECT_EQ(choose_by_error(at_edge, {view}, {1e9, any}).error(), 0.0);
}

// An eye of a headset: rotated, and its picture is not symmetric about its middle.
TEST(ChoiceByError, RespectsPictureEdges) {
  shared::View view{};
  view.anchor = {1, 2, 3, 0.2f};
  view.row_x = {0, 0, -1, 0};
  view.row_y = {0, 1, 0, 0};
  view.row_z = {1, 0, 0, 0};
  view.lens = {100, 80, 30, 60};
  view.width = 100;
  view.height = 90;
  const DetailView detail = detail_views({&view, 1}).front();
  const auto sees = [&](double x, double y, double depth) {  // px
    const glm::dvec3 at(depth, (y - 60.0) / 80.0 * depth, -(x - 30.0) / 100.0 * depth);
    return std::ranges::all_of(detail.inward, [&](const glm::dvec3& n) { return glm::dot(n, at) > 0.0; });
  };
  for (const double depth : {0.5, 70.0}) {
    for (const double x : {1.0, 99.0}) {
      for (const double y : {1.0, 89.0}) EXPECT_TRUE(sees(x, y, depth));
    }
    for (const double x : {-1.0, 101.0}) EXPECT_FALSE(sees(x, 45.0, depth)) << x;
    for (const double y : {-1.0, 91.0}) EXPECT_FALSE(sees(50.0, y, depth)) << y;
    EXPECT_FALSE(sees(50.0, 45.0, -depth)) << "behind";
  }
}

// Chunks that are hidden or outside the picture need not be fine.
TEST(ChoiceByError, UsesVisibility) {
  const std::vector<LodChunk> chunks = row_with_errors(8);
  const DetailView view = along_x(-1.0);
  const LevelChoice blind = choose_by_error(chunks, {view}, {1e-4, any});
  std::vector<ChunkVisibility> seen;
  for (const LodChunk& chunk : chunks) seen.push_back(open_view(chunk, view));
  const Levels coarsest(chunks.size(), 3);
  const auto by = [&](const std::vector<ChunkVisibility>& found, const Levels& drawn) {
    return choose_by_error(chunks, {view}, {1e-4, any}, {{found}, drawn}, drawn);
  };
  EXPECT_NEAR(by(seen, Levels()).error(), blind.error(), 1e-12) << "nothing hides anything";
  constexpr double hidden = 1e-9;  // px
  for (std::size_t p = 1; p < chunks.size(); ++p) seen[p].area = hidden;
  const LevelChoice first_only = by(seen, coarsest);
  EXPECT_EQ(first_only.levels[0], blind.levels[0]);
  for (std::size_t p = 1; p < chunks.size(); ++p) EXPECT_EQ(first_only.levels[p], 3u) << p;
  EXPECT_LT(first_only.error(), blind.error());
  // The loss of a chunk is proportional to its visible area.
  for (ChunkVisibility& chunk : seen) chunk.area *= 0.5;
  EXPECT_NEAR(by(seen, coarsest).error(), 0.5 * loss({chunks[0]}, {by(seen, coarsest).levels[0]}, view),
              1e-12);
  // Coarser levels than the drawn ones may show chunks that are hidden now.
  for (ChunkVisibility& chunk : seen) chunk.area = hidden;
  EXPECT_LT(by(seen, coarsest).error(), 1e-9);
  EXPECT_EQ(by(seen, coarsest).levels, coarsest);
  EXPECT_GT(by(seen, Levels(chunks.size(), 0)).error(), 1e-6);
  // Finer levels may also show more: the drawn level has no Gaussian in the picture, but the chunk may extend
  // into it.
  const std::vector<ChunkVisibility> nothing(chunks.size());
  const DetailView ahead = along_x(6.5);
  const auto ahead_by = [&](const std::vector<ChunkVisibility>& found, double error) {
    return choose_by_error(chunks, {ahead}, {error, any, false}, {{found}, coarsest}, coarsest);
  };
  EXPECT_GT(ahead_by(nothing, 1.0).error(), 1e-6);
  EXPECT_LT(ahead_by(seen, 1.0).error(), 1e-9) << "hidden is not beside the picture";
  const Levels finer = ahead_by(nothing, 1e-6).levels;
  EXPECT_LT(finer.back(), 3u);
  EXPECT_EQ(finer.front(), 3u) << "behind the eye";
}

TEST(ChoiceByError, HasHysteresis) {
  const std::vector<LodChunk> chunks = row_with_errors(20);
  std::size_t anew = 0;
  for (double x = -12.0; x < -0.5; x += 0.25) {
    Levels here = choose_by_error(chunks, {along_x(x)}, {1e-4, any}).levels;
    // Once levels have settled, small movements switch none.
    here = choose_by_error(chunks, {along_x(x)}, {1e-4, any}, {}, here).levels;
    for (const double by : {0.97, 1.03}) {
      const LevelChoice kept = choose_by_error(chunks, {along_x(x * by)}, {1e-4, any}, {}, here);
      EXPECT_EQ(kept.levels, here) << x << " times " << by;
      EXPECT_LE(kept.error(), 1.1e-4 * 1.0001);
      anew += choose_by_error(chunks, {along_x(x * by)}, {1e-4, any}).levels != here;
    }
  }
  EXPECT_GT(anew, 10u) << "without a memory it would switch";
  const Levels far = choose_by_error(chunks, {along_x(-100.0)}, {1e-4, any}).levels;
  EXPECT_NE(choose_by_error(chunks, {along_x(-1.0)}, {1e-4, any}, {}, far).levels, far);
}

// If not all levels arrive in time, many chunks get a few levels, instead of a few chunks all of theirs.
TEST(ChoiceByError, LimitsReads) {
  const std::vector<LodChunk> chunks = row_with_errors(200);
  const DetailView view = along_x(-1.0);
  const Levels coarsest(chunks.size(), 3);
  const auto wanted = [&](std::size_t max_read, const Levels& drawn) {
    return choose_by_error(chunks, {view}, {1e-6, any, false, max_read}, {{}, drawn});
  };
  const auto gaussians = [&](std::size_t p, const Levels& levels) {
    return levels[p] < coarsest[p] ? chunks[p].levels[levels[p]].count : 0;
  };
  const LevelChoice all = wanted(any, coarsest);
  std::size_t needed = 0;
  for (std::size_t p = 0; p < chunks.size(); ++p) needed += gaussians(p, all.levels);
  EXPECT_FALSE(all.is_limited);
  EXPECT_FALSE(wanted(needed, coarsest).is_limited);
  EXPECT_EQ(wanted(needed, coarsest).levels, all.levels);
  Levels order;  // chunks, sorted by the error saved per Gaussian
  for (std::size_t p = 0; p < chunks.size(); ++p) order.push_back(p);
  std::ranges::sort(order, std::greater<>(), [&](std::size_t p) {
    return all.error_saved(p, 3, all.levels[p]) /
           std::max(1.0, static_cast<double>(gaussians(p, all.levels)));
  });
  for (const std::size_t max_read : {needed / 8, needed / 4, needed / 2}) {
    const LevelChoice some = wanted(max_read, coarsest);
    EXPECT_TRUE(some.is_limited) << max_read;
    std::size_t come = 0, left = max_read;
    for (std::size_t p = 0; p < chunks.size(); ++p) come += gaussians(p, some.levels);
    EXPECT_LE(come, max_read);
    EXPECT_GT(come, max_read / 2);
    Levels few = coarsest;
    for (const std::size_t p : order) {
      if (gaussians(p, all.levels) > left) continue;
      left -= gaussians(p, all.levels);
      few[p] = all.levels[p];
    }
    EXPECT_LT(some.error(), all.error_of(few)) << max_read << ", injected: one chunk after another";
  }
  EXPECT_EQ(std::ranges::count(wanted(0, coarsest).levels, 3u), 199) << "one chunk's, or nothing ever comes";
  EXPECT_EQ(wanted(needed / 4, all.levels).levels, all.levels) << "all is there";
  EXPECT_FALSE(wanted(needed / 4, all.levels).is_limited);
  EXPECT_FALSE(wanted(0, {}).is_limited) << "nobody looked";
}

TEST(ChoiceByError, ReportsErrorSaved) {
  const std::vector<LodChunk> chunks = row_with_errors(4);
  const DetailView near = along_x(-1.0), far = along_x(-9.0), away = along_x(-1.0, -1.0);
  const LevelChoice choice = choose_by_error(chunks, {near, far}, {1e-3, any});
  const LevelChoice unseen = choose_by_error(chunks, {away}, {1e-3, any});
  for (std::size_t p = 0; p < chunks.size(); ++p) {
    Levels coarse(chunks.size(), 3), finer = coarse;
    finer[p] = 1;
    EXPECT_NEAR(choice.error_saved(p, 3, 1), loss(chunks, coarse, near) - loss(chunks, finer, near), 1e-12)
        << p;
    EXPECT_LT(loss(chunks, coarse, far) - loss(chunks, finer, far), 0.9 * choice.error_saved(p, 3, 1))
        << "injected: of the view that gains less";
    EXPECT_EQ(choice.error_saved(p, 1, 3), 0.0);
    EXPECT_GT(unseen.error_saved(p, 3, 1), 0.0) << "of the sphere";
  }
}

TEST(ChoiceByError, HandlesSmallBudgetAndUnknownParts) {
  std::vector<LodChunk> chunks = row_with_errors(6);
  for (std::size_t most = 300; most < 2500; most += 50) {
    Levels chosen = choose_by_error(chunks, {along_x(-1.0)}, {1e-9, most}).levels;
    EXPECT_LE(test::gaussians_of(chunks, chosen), most);
    for (std::size_t& level : chosen) {
      if (level == 0) continue;
      --level;
      EXPECT_GT(test::gaussians_of(chunks, chosen), most) << "room for a step is left";
      ++level;
    }
  }
  // If the best step is too large, a smaller one is taken.
  const std::vector<LodChunk> leap = {
      {{},
       {1, 1, 1},
       {{0, 400, std::vector(6, 0.0)}, {1, 200, std::vector(6, 0.9)}, {2, 100, std::vector(6, 1.0)}},
       {0.01},
       std::vector(6, 100.0)}};
  EXPECT_EQ(choose_by_error(leap, {along_x(-1.0)}, {1e-9, 400}).levels, Levels{0});
  EXPECT_EQ(choose_by_error(leap, {along_x(-1.0)}, {1e-9, 399}).levels, Levels{1});
  chunks[3].pixels.clear();
  chunks[3].seen.clear();
  for (LodChunk::Level& level : chunks[3].levels) level.errors.clear();
  chunks[4].levels.clear();
  const LevelChoice choice = choose_by_error(chunks, {along_x(-1.0)}, {1e9, any});
  EXPECT_EQ(choice.levels, (Levels{3, 3, 3, 0, 0, 3}));
  EXPECT_EQ(choose_by_error(chunks, {along_x(-1.0)}, {1e9, 450}).levels[3], 1u);
  EXPECT_TRUE(choose_by_error({}, {along_x(0.0)}, {1.0, any}).levels.empty());
}

// This holds for any number of changes and views.
TEST(RunningError, TracksLevels) {
  constexpr std::size_t parts = 40, levels_of_part = 3, views = 2;
  Random random(3);
  auto choice = std::make_shared<LevelChoice>();
  choice->pixels = {10.0, 20.0};
  choice->sphere_pixels = 1000.0;
  choice->first = {0};
  for (std::size_t p = 0; p < parts; ++p) {
    for (std::size_t n = 0; n < (views + 1) * levels_of_part; ++n)
      choice->errors.push_back(n % levels_of_part == 0 ? 0.0 : random.uniform(0.0, 1.0));
    choice->first.push_back(choice->errors.size());
  }
  std::vector<std::size_t> levels(parts, 2);
  RunningError lost(choice, levels);
  const double at_first = lost.error(0, views);
  for (std::size_t n = 0; n < 200; ++n) {
    levels[n * 7 % parts] = n / 3 % levels_of_part;
    if (n % 4 != 0) continue;
    lost.follow(levels);
    EXPECT_NEAR(lost.error(0, views), choice->error_of(levels), 1e-12);
    EXPECT_NEAR(lost.error(1, 2), choice->error_of_view(1, levels), 1e-12);
  }
  EXPECT_GT(std::abs(lost.error(0, views) - at_first), 0.01) << "injected: what it began with";
  lost.follow(std::vector<std::size_t>(parts, 0));
  EXPECT_GE(lost.error(0, views), 0.0);
  EXPECT_NEAR(lost.error(0, views), 0.0, 1e-12);
}

}  // namespace
}  // namespace binosplat
