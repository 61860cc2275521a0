#include "measure/search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "support/errors.h"

namespace binosplat::measure {
namespace {

/// What PSNR does: falls by 20 dB a decade from 40 dB at a loss of 0.1.
double psnr_like(double loss) { return 20.0 - 20.0 * std::log10(loss); }

TEST(FindLoss, MeetsTheTargetFromEitherSide) {
  for (const double start : {1e-6, 0.1, 1.0, 1e6}) {
    const FoundLoss found = find_loss(psnr_like, 40.0, {.start = start});
    EXPECT_NEAR(found.loss, 0.1, 0.001) << "from " << start;
    EXPECT_GE(found.value, 40.0);
    EXPECT_LE(found.value, 40.01);
    EXPECT_EQ(found.value, psnr_like(found.loss));
    EXPECT_LE(found.evaluations, 14) << "from " << start;
  }
  EXPECT_EQ(find_loss(psnr_like, 40.0, {.start = 0.1}).evaluations, 1);
}

TEST(FindLoss, CopesWithBends) {
  const auto hyperbola = [](double loss) { return 1.0 / loss; };
  const auto knee = [](double loss) { return loss < 3.0 ? 100.0 : 50.0 - loss; };
  EXPECT_NEAR(find_loss(hyperbola, 1e-3, {.tolerance = 1e-6}).loss, 1000.0, 1.0);
  EXPECT_NEAR(find_loss(knee, 20.0).loss, 30.0, 0.011);
  const FoundLoss at_step = find_loss(knee, 60.0);
  EXPECT_NEAR(at_step.loss, 3.0, 1e-5);
  EXPECT_EQ(at_step.value, 100.0);
  EXPECT_LT(at_step.evaluations, 40);
}

TEST(FindLoss, CopesWithInfinity) {
  // Small losses leave every pair: the pictures are equal.
  const auto value = [](double loss) {
    return loss < 0.01 ? std::numeric_limits<double>::infinity() : psnr_like(loss);
  };
  EXPECT_NEAR(find_loss(value, 40.0, {.start = 1e-4}).loss, 0.1, 0.001);
}

TEST(FindLoss, KeepsTheLargestThatWasSeenToHold) {
  // A fall with waves on it: what is returned has been asked and holds, and nothing larger that was asked
  // does.
  for (int phase = 0; phase < 20; ++phase) {
    std::vector<std::pair<double, double>> asked;
    const auto value = [&](double loss) {
      asked.emplace_back(loss, psnr_like(loss) + 1.5 * std::sin(phase + 20.0 * std::log(loss)));
      return asked.back().second;
    };
    const FoundLoss found = find_loss(value, 40.0);
    double best = 0.0;
    for (const auto& [loss, at_loss] : asked) {
      if (at_loss >= 40.0) best = std::max(best, loss);
    }
    EXPECT_EQ(found.loss, best);
    EXPECT_EQ(found.evaluations, static_cast<int>(asked.size()));
    EXPECT_GE(found.value, 40.0);
    EXPECT_LE(found.value, 40.01);
  }
}

TEST(FindLoss, EndsAtItsLimits) {
  const auto always = [](double) { return 50.0; };
  const FoundLoss all = find_loss(always, 40.0, {.largest = 100.0});
  EXPECT_DOUBLE_EQ(all.loss, 100.0);
  const auto only_exact = [](double loss) { return loss > 0.0 ? 30.0 : 90.0; };
  const FoundLoss none = find_loss(only_exact, 40.0, {.smallest = 1e-3});
  EXPECT_EQ(none.loss, 0.0);
  EXPECT_EQ(none.value, 90.0);
  EXPECT_LE(find_loss([](double loss) { return -loss; }, -5.0, {.tolerance = 0.0, .evaluations = 6}).loss,
            5.0);
  EXPECT_LE(find_loss(psnr_like, 40.0, {.evaluations = 3}).evaluations, 4);
}

TEST(FindLoss, SaysWhatCannotBe) {
  const auto bad = [](double) { return 30.0; };
  EXPECT_TRUE(test::fails_saying([&] { find_loss(bad, 40.0); }, {"no loss reaches 40", "30"}));
  EXPECT_TRUE(test::fails_saying([&] { find_loss(bad, 40.0, {.start = 0.0}); }, {"above 0"}));
}

}  // namespace
}  // namespace binosplat::measure
