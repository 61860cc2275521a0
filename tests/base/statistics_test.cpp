#include "base/statistics.h"

#include <gtest/gtest.h>

namespace binosplat {
namespace {

TEST(Quantile, UsesNearestRank) {
  const std::vector<double> values = {5, 1, 4, 2, 3};
  EXPECT_EQ(quantile(values, 0.0), 1);
  EXPECT_EQ(quantile(values, 0.2), 1);
  EXPECT_EQ(quantile(values, 0.21), 2);
  EXPECT_EQ(quantile(values, 0.5), 3);
  EXPECT_EQ(quantile(values, 0.99), 5);
  EXPECT_EQ(quantile({7}, 0.5), 7);
  EXPECT_EQ(quantile({1, 2}, 0.5), 1);
}

TEST(StudentT, MatchesTables) {
  EXPECT_NEAR(student_t(0.05, 1), 12.706, 1e-3);
  EXPECT_NEAR(student_t(0.05, 2), 4.303, 1e-3);
  EXPECT_NEAR(student_t(0.01, 7), 3.499, 1e-3);
  EXPECT_NEAR(student_t(0.001, 30), 3.646, 1e-3);
  EXPECT_NEAR(student_t(0.05, 100'000), 1.960, 1e-3);
}

TEST(SpreadEvenly, TakesBothEnds) {
  EXPECT_EQ(spread_evenly(10, 1), (std::vector<std::size_t>{0}));
  EXPECT_EQ(spread_evenly(10, 4), (std::vector<std::size_t>{0, 3, 6, 9}));
  EXPECT_EQ(spread_evenly(3, 7), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_TRUE(spread_evenly(0, 3).empty());
}

}  // namespace
}  // namespace binosplat
