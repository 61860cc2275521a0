#include "lab/bench_compare.h"

#include <gtest/gtest.h>

#include "base/statistics.h"
#include "support/models.h"

namespace binosplat::lab {
namespace {

using Lines = std::vector<std::string>;

BenchPoint timed(const std::string& name, std::vector<double> repeats_ms) {
  BenchPoint p;
  p.scene = "fox";
  p.size = "own";
  p.name = p.settings.th = name;
  p.device = "llvmpipe";
  p.repeats_ms = std::move(repeats_ms);
  p.frame_ms = mean(p.repeats_ms);
  p.pairs = 5000.0;
  p.exact.psnr_db = 40.0;
  return p;
}

/// Eight ways to draw, of 1 to 8 ms, whose repeats scatter by some 3 %.
std::vector<BenchPoint> run_with(int repeats, std::uint32_t seed) {
  test::Uniform random(seed);
  std::vector<BenchPoint> points;
  for (int k = 1; k <= 8; ++k) {
    std::vector<double> ms;
    for (int r = 0; r < repeats; ++r) ms.push_back(k * (1.0 + random(-0.05, 0.05)));
    points.push_back(timed("way " + std::to_string(k), ms));
  }
  return points;
}

TEST(BenchComparison, FindsNothingInEqualRuns) {
  for (const int repeats : {2, 3, 5}) {
    int changed = 0;
    for (std::uint32_t pair = 0; pair < 50; ++pair)
      changed +=
          compare_results(run_with(repeats, 2 * pair), run_with(repeats, 2 * pair + 1)).lines.size() > 1;
    EXPECT_LE(changed, 3) << "of 50 pairs with " << repeats << " repeats";
  }
}

TEST(BenchComparison, FindsWhatHasChanged) {
  const std::vector<BenchPoint> before = run_with(3, 1);
  std::vector<BenchPoint> now = run_with(3, 2);
  for (double& ms : now[4].repeats_ms) ms *= 1.2;
  now[4].frame_ms = mean(now[4].repeats_ms);
  now[2].frame_ms *= 0.7;
  BenchComparison found = compare_results(before, now);
  ASSERT_EQ(found.lines.size(), 3u) << found.lines[0];
  EXPECT_EQ(found.slowest, "fox, one eye, own, way 5");
  EXPECT_NEAR(found.slower_percent, 20.0, 6.0);
  EXPECT_EQ(found.lines.back(), "2 of 8 points in both runs changed beyond noise; 0 are new, 0 are gone");
  now[0].exact.psnr_db = 39.9;
  now[1].pairs = 4994.0;
  now[7].settings.tile = 8;
  found = compare_results(before, now);
  EXPECT_EQ(found.lines[0], "fox, one eye, own, way 1: 40.00 dB -> 39.90 dB");
  EXPECT_EQ(found.lines[1], "fox, one eye, own, way 2: 5000 pairs -> 4994");
  EXPECT_EQ(found.lines.back(), "4 of 7 points in both runs changed beyond noise; 1 are new, 1 are gone");
}

TEST(BenchComparison, KnowsNoNoiseOfASingleRepeat) {
  const BenchComparison found = compare_results({timed("a", {4.0})}, {timed("a", {8.0})});
  EXPECT_EQ(found.lines,
            (Lines{"0 of 1 points in both runs changed beyond noise; 0 are new, 0 are gone. Times "
                   "were not compared: with one repeat a point nothing tells their noise"}));
  EXPECT_EQ(found.slower_percent, 0.0);
}

TEST(BenchComparison, NamesPointsWithoutTimesAndComparesTheOthers) {
  std::vector<BenchPoint> now = run_with(3, 2);
  for (double& ms : now[4].repeats_ms) ms *= 1000.0;
  now[4].frame_ms = mean(now[4].repeats_ms);
  for (const double broken : {0.0, -1.0, static_cast<double>(INFINITY), static_cast<double>(NAN)}) {
    for (const bool in_repeats : {false, true}) {
      std::vector<BenchPoint> before = run_with(3, 1);
      (in_repeats ? before[6].repeats_ms[1] : before[6].frame_ms) = broken;
      const BenchComparison found = compare_results(before, now);
      EXPECT_EQ(found.slowest, "fox, one eye, own, way 5") << broken;
      EXPECT_EQ(found.matched, 8u);
      EXPECT_EQ(found.timed, 7u);
      ASSERT_EQ(found.lines.size(), 3u);
      EXPECT_EQ(found.lines[0].find("fox, one eye, own, way 7: its times cannot be compared"), 0u);
      EXPECT_EQ(found.lines.back(), "1 of 7 points in both runs changed beyond noise; 0 are new, 0 are gone");
      EXPECT_EQ(compare_results(now, before).timed, 7u);
    }
  }
  EXPECT_EQ(compare_results(run_with(3, 1), now).timed, 8u) << "planted: none is broken";
}

TEST(BenchComparison, TakesOlderResults) {
  BenchPoint older = timed("a", {4.0});
  older.repeats_ms.clear();  // which were not kept, but for half their spread
  older.noise_ms = 0.01;
  EXPECT_EQ(compare_results({older}, {timed("a", {4.05, 4.07, 4.06})}).lines.size(), 1u);
  EXPECT_EQ(compare_results({older}, {timed("a", {5.0, 5.02, 5.01})}).lines.size(), 2u);
}

}  // namespace
}  // namespace binosplat::lab
