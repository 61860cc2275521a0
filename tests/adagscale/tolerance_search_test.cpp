#include "adagscale/tolerance_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "support/errors.h"

namespace binosplat::adagscale {
namespace {

/// Returns a value like PSNR: it falls by 20 dB a decade from 40 dB at a tolerance of 0.1.
double psnr_like(double tolerance) { return 20.0 - 20.0 * std::log10(tolerance); }

TEST(FindTolerance, MeetsTargetFromEitherSide) {
  for (const double start : {1e-6, 0.1, 1.0, 1e6}) {
    const FoundTolerance found = find_tolerance(psnr_like, 40.0, {.start = start});
    EXPECT_NEAR(found.tolerance, 0.1, 0.001) << "from " << start;
    EXPECT_GE(found.value, 40.0);
    EXPECT_LE(found.value, 40.01);
    EXPECT_EQ(found.value, psnr_like(found.tolerance));
    EXPECT_LE(found.evaluations, 14) << "from " << start;
  }
  EXPECT_EQ(find_tolerance(psnr_like, 40.0, {.start = 0.1}).evaluations, 1);
}

TEST(FindTolerance, HandlesNonlinearCurves) {
  const auto hyperbola = [](double tolerance) { return 1.0 / tolerance; };
  const auto knee = [](double tolerance) { return tolerance < 3.0 ? 100.0 : 50.0 - tolerance; };
  EXPECT_NEAR(find_tolerance(hyperbola, 1e-3, {.within = 1e-6}).tolerance, 1000.0, 1.0);
  EXPECT_NEAR(find_tolerance(knee, 20.0).tolerance, 30.0, 0.011);
  const FoundTolerance at_step = find_tolerance(knee, 60.0);
  EXPECT_NEAR(at_step.tolerance, 3.0, 1e-5);
  EXPECT_EQ(at_step.value, 100.0);
  EXPECT_LT(at_step.evaluations, 40);
}

TEST(FindTolerance, HandlesInfinity) {
  // Small tolerances keep every pair, so the pictures are equal.
  const auto value = [](double tolerance) {
    return tolerance < 0.01 ? std::numeric_limits<double>::infinity() : psnr_like(tolerance);
  };
  EXPECT_NEAR(find_tolerance(value, 40.0, {.start = 1e-4}).tolerance, 0.1, 0.001);
}

TEST(FindTolerance, KeepsLargestValidTolerance) {
  // The function falls with waves. The returned tolerance was evaluated and reaches the target, and no larger
  // one that was evaluated does.
  for (int phase = 0; phase < 20; ++phase) {
    std::vector<std::pair<double, double>> asked;
    const auto value = [&](double tolerance) {
      asked.emplace_back(tolerance,
                         psnr_like(tolerance) + 1.5 * std::sin(phase + 20.0 * std::log(tolerance)));
      return asked.back().second;
    };
    const FoundTolerance found = find_tolerance(value, 40.0);
    double best = 0.0;
    for (const auto& [tolerance, at_tolerance] : asked) {
      if (at_tolerance >= 40.0) best = std::max(best, tolerance);
    }
    EXPECT_EQ(found.tolerance, best);
    EXPECT_EQ(found.evaluations, static_cast<int>(asked.size()));
    EXPECT_GE(found.value, 40.0);
    EXPECT_LE(found.value, 40.01);
  }
}

TEST(FindTolerance, EndsAtLimits) {
  const auto always = [](double) { return 50.0; };
  const FoundTolerance all = find_tolerance(always, 40.0, {.largest = 100.0});
  EXPECT_DOUBLE_EQ(all.tolerance, 100.0);
  const auto only_exact = [](double tolerance) { return tolerance > 0.0 ? 30.0 : 90.0; };
  const FoundTolerance none = find_tolerance(only_exact, 40.0, {.smallest = 1e-3});
  EXPECT_EQ(none.tolerance, 0.0);
  EXPECT_EQ(none.value, 90.0);
  EXPECT_LE(
      find_tolerance([](double tolerance) { return -tolerance; }, -5.0, {.within = 0.0, .evaluations = 6})
          .tolerance,
      5.0);
  EXPECT_LE(find_tolerance(psnr_like, 40.0, {.evaluations = 3}).evaluations, 4);
}

TEST(FindTolerance, ReportsUnreachableTarget) {
  const auto bad = [](double) { return 30.0; };
  EXPECT_ERROR(find_tolerance(bad, 40.0), "no tolerance reaches 40", "30");
  EXPECT_ERROR(find_tolerance(bad, 40.0, {.start = 0.0}), "expected 0 < smallest");
}

}  // namespace
}  // namespace binosplat::adagscale
