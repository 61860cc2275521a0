// The differences between two runs that are real, and those that are noise.

#include <gtest/gtest.h>

#include "base/statistics.h"
#include "lab/results.h"
#include "support/models.h"

namespace binosplat::lab {
namespace {

using Lines = std::vector<std::string>;

Row timed(const std::string& name, const std::vector<double>& repeats_ms) {
  Row row = object("scene", "fox", "eyes", 1, "size", "own", "threshold", name, "name", name, "device",
                   "llvmpipe", "frame_ms", mean(repeats_ms), "frames", 60, "pairs", 5000.0, "psnr_db", 40.0);
  row["repeats_ms"] = repeats_ms;
  return row;
}

void slow_down(Row& row, const char* list, double factor) {
  for (auto& ms : row[list]) ms = ms.get<double>() * factor;
}

/// Returns eight settings of 1 to 8 ms, whose repeats scatter by about 3 %.
std::vector<Row> run_with(int repeats, std::uint32_t seed) {
  test::Uniform random(seed);
  std::vector<Row> rows;
  for (int k = 1; k <= 8; ++k) {
    std::vector<double> ms;
    for (int r = 0; r < repeats; ++r) ms.push_back(k * (1.0 + random(-0.05, 0.05)));
    rows.push_back(timed("way " + std::to_string(k), ms));
  }
  return rows;
}

TEST(RunComparison, FindsNothingInEqualRuns) {
  for (const int repeats : {2, 3, 5}) {
    int changed = 0;
    for (std::uint32_t pair = 0; pair < 50; ++pair)
      changed += compare_runs(run_with(repeats, 2 * pair), run_with(repeats, 2 * pair + 1)).lines.size() > 1;
    EXPECT_LE(changed, 3) << "of 50 pairs with " << repeats << " repeats";
  }
}

TEST(RunComparison, FindsChanges) {
  const std::vector<Row> before = run_with(3, 1);
  std::vector<Row> now = run_with(3, 2);
  slow_down(now[4], "repeats_ms", 1.2);
  slow_down(now[2], "repeats_ms", 0.7);
  RunComparison found = compare_runs(before, now);
  ASSERT_EQ(found.lines.size(), 3u) << found.lines[0];
  EXPECT_EQ(found.slowest, "fox, one eye, size own, way 5");
  EXPECT_NEAR(found.slower_percent, 20.0, 6.0);
  EXPECT_EQ(found.lines.back(),
            "2 numbers of 8 points in both runs changed beyond noise; 0 points are new, 0 are gone");
  now[0]["psnr_db"] = 39.9;
  now[1]["pairs"] = 4994.0;
  now[7]["precision"] = "half";
  found = compare_runs(before, now);
  EXPECT_EQ(found.lines[2], "fox, one eye, size own, way 1: PSNR dB 40.00 -> 39.90");
  EXPECT_EQ(found.lines[3], "fox, one eye, size own, way 2: pairs 5000 -> 4994");
  EXPECT_EQ(found.lines.back(),
            "4 numbers of 7 points in both runs changed beyond noise; 1 points are new, 1 are gone");
}

// Stretches of a path differ, so each is compared with itself.
TEST(RunComparison, ComparesRepeatsInOrder) {
  const std::vector<double> stretches = {1.0, 4.0, 2.0, 9.0, 3.0};
  std::vector<double> slower = stretches;
  for (double& ms : slower) ms *= 1.05;
  EXPECT_EQ(compare_runs({timed("a", stretches)}, {timed("a", slower)}).lines.size(), 2u);
  std::ranges::reverse(slower);
  EXPECT_EQ(compare_runs({timed("a", stretches)}, {timed("a", slower)}).lines.size(), 1u) << "injected";
}

// If the CPU draws, other programs take its time and frames wait: that is no change.
TEST(RunComparison, SoftwareRenderingUsesCpuTime) {
  std::vector<Row> before = run_with(3, 1), now = run_with(3, 2);
  for (std::vector<Row>* run : {&before, &now}) {
    for (Row& row : *run) row["cpu_repeats_ms"] = row["repeats_ms"];
  }
  for (Row& row : now) slow_down(row, "repeats_ms", 1.6);
  EXPECT_EQ(compare_runs(before, now).lines.size(), 1u);
  for (Row& row : now) slow_down(row, "cpu_repeats_ms", 1.6);
  EXPECT_EQ(compare_runs(before, now).lines.size(), 9u) << "injected: it truly became slower";
  for (Row& row : now) row["waited"] = 65.0;
  EXPECT_EQ(compare_runs(before, now).lines.size(), 1u) << "other programs had the CPU for longer than that";
}

TEST(RunComparison, SingleRepeatHasNoNoise) {
  const RunComparison found = compare_runs({timed("a", {4.0})}, {timed("a", {8.0})});
  EXPECT_EQ(found.lines,
            (Lines{"0 numbers of 1 points in both runs changed beyond noise; 0 points are new, 0 are "
                   "gone. Times were not compared, because one repeat per point shows no noise"}));
  EXPECT_EQ(found.slower_percent, 0.0);
  EXPECT_EQ(found.timed, 0u);
}

TEST(RunComparison, ReportsPointsWithoutTimes) {
  std::vector<Row> now = run_with(3, 2);
  slow_down(now[4], "repeats_ms", 1000.0);
  const auto broken = [](const nlohmann::ordered_json& value) {
    Row row = run_with(3, 1)[6];
    row["repeats_ms"][1] = value;
    return row;
  };
  Row fewer = run_with(2, 1)[6], other_frames = run_with(3, 1)[6];
  other_frames["frames"] = 59;
  for (const Row& row : {broken(0.0), broken(-1.0), broken(nullptr), broken("x"), fewer, other_frames}) {
    std::vector<Row> before = run_with(3, 1);
    before[6] = row;
    const RunComparison found = compare_runs(before, now);
    EXPECT_EQ(found.slowest, "fox, one eye, size own, way 5") << row;
    EXPECT_EQ(found.matched, 8u);
    EXPECT_EQ(found.timed, 7u) << row;
    ASSERT_EQ(found.lines.size(), 3u) << row;
    EXPECT_EQ(found.lines[0].find("fox, one eye, size own, way 7: its times cannot be compared"), 0u);
    EXPECT_EQ(compare_runs(now, before).timed, 7u);
  }
  EXPECT_EQ(compare_runs(run_with(3, 1), now).timed, 8u) << "injected: none is broken";
}

// A faster machine must not hide that the program became slower.
TEST(RunComparison, IgnoresTimesOfOtherDevices) {
  const Row was = timed("a", {1.0, 1.1, 1.0});
  Row is = timed("a", {0.1, 0.11, 0.1});
  is["device"] = "another GPU";
  const RunComparison found = compare_runs({was}, {is});
  EXPECT_EQ(found.matched, 1u);
  EXPECT_EQ(found.timed, 0u);
  ASSERT_EQ(found.lines.size(), 2u);
  EXPECT_EQ(found.lines[0], "times on llvmpipe and on another GPU are not compared");
}

}  // namespace
}  // namespace binosplat::lab
