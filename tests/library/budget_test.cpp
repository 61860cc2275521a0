// FrameBudget: the effort that a frame's time allows.

#include <binosplat/report.h>
#include <gtest/gtest.h>

#include <optional>

namespace binosplat {
namespace {

Report drawn(double ms, ExactReason exact = ExactReason::not_exact) {
  Report report;
  report.gpu_ms = ms;
  report.exact = exact;
  return report;
}

TEST(FrameBudgetTest, FollowsFrameTime) {
  constexpr double period = 11.1;
  FrameBudget budget(10.0);
  EXPECT_FALSE(budget.effort().quality) << "exact while that is in time";
  for (int n = 0; n < 100; ++n) budget.took(drawn(9.0), period);
  EXPECT_FALSE(budget.effort().quality);
  budget.took(drawn(10.5), period);
  EXPECT_FALSE(budget.effort().quality) << "one frame may be late";
  budget.took(drawn(10.5), period);
  EXPECT_GT(budget.effort().quality, 40.0f);
  for (int n = 0; n < 10; ++n) budget.took(drawn(20.0), period);
  EXPECT_EQ(budget.effort().quality, 37.0f);
  EXPECT_LT(budget.effort().scale, 1.0);
  for (int n = 0; n < 50; ++n) budget.took(drawn(20.0), period);
  EXPECT_EQ(budget.effort().scale, 0.5) << "no less";
  const double before = budget.effort().scale;
  for (int n = 0; n < 100; ++n) budget.took(drawn(9.0), period);
  EXPECT_EQ(budget.effort().scale, before) << "more might be too much";
  for (int n = 0; n < 60000; ++n) budget.took(drawn(3.0), period);
  EXPECT_FALSE(budget.effort().quality);
}

// If a scene is slightly too slow at one effort, the budget does not try that effort again and again.
TEST(FrameBudgetTest, DoesNotOscillate) {
  FrameBudget budget(10.0);
  int changes = 0;
  std::optional<float> last = budget.effort().quality;
  for (int n = 0; n < 9000; ++n) {  // 100 s
    budget.took(drawn(!budget.effort().quality ? 12.0 : 7.0), 11.1);
    changes += budget.effort().quality != last ? 1 : 0;
    last = budget.effort().quality;
  }
  EXPECT_LE(changes, 15);
  EXPECT_GE(changes, 3) << "it is tried again";
}

// Exact frames after a turn of the head are no reason for a lower quality, as long as they are few.
TEST(FrameBudgetTest, IgnoresFewUnmeasuredFrames) {
  FrameBudget budget(10.0);
  for (int n = 0; n < 3; ++n) budget.took(drawn(11.0), 11.1);
  const Effort approximate = budget.effort();
  ASSERT_TRUE(approximate.quality);
  budget.took(drawn(8.0), 11.1);
  for (int turn = 0; turn < 10; ++turn) {
    for (int n = 0; n < 16; ++n) budget.took(drawn(20.0, ExactReason::unmeasured), 11.1);
    EXPECT_EQ(budget.effort().quality, approximate.quality);
    budget.took(drawn(8.0), 11.1);
  }
  for (int n = 0; n < 17; ++n) budget.took(drawn(20.0, ExactReason::unmeasured), 11.1);
  EXPECT_LT(budget.effort().quality, approximate.quality) << "a turn that goes on takes its time, too";
}

}  // namespace
}  // namespace binosplat
