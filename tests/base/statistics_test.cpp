#include "base/statistics.h"

#include <gtest/gtest.h>

namespace binosplat {
namespace {

TEST(Quantile, IsTheSmallestValueThatEnoughDoNotExceed) {
  const std::vector<double> values = {5, 1, 4, 2, 3};
  EXPECT_EQ(quantile(values, 0.0), 1);
  EXPECT_EQ(quantile(values, 0.2), 1);
  EXPECT_EQ(quantile(values, 0.21), 2);
  EXPECT_EQ(quantile(values, 0.5), 3);
  EXPECT_EQ(quantile(values, 0.99), 5);
  EXPECT_EQ(quantile({7}, 0.5), 7);
  EXPECT_EQ(quantile({1, 2}, 0.5), 1);
}

}  // namespace
}  // namespace binosplat
