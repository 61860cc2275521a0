#include "base/log.h"

#include <gtest/gtest.h>

#include <thread>

#include "base/progress.h"

namespace binosplat {
namespace {

TEST(Log, WritesLinesToStandardError) {
  testing::internal::CaptureStderr();
  log_info("{} Gaussians", 3);
  log_warning("{} left out", 1);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "binosplat: 3 Gaussians\nbinosplat: warning: 1 left out\n");
}

TEST(Log, ReplacesControlCharacters) {
  testing::internal::CaptureStderr();
  log_line("a\x1b[2Jb\rc\x7f, \"\u00e4\"\n  next");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "binosplat: a?[2Jb?c?, \"\u00e4\"\n  next\n");
}

TEST(Log, MergesEqualWarnings) {
  testing::internal::CaptureStderr();
  {
    const WarningsOnce once;
    log_warning("b");
    {
      const WarningsOnce inner;
      for (int i = 0; i < 3; ++i) log_warning("a {}", 1);
    }
    log_info("told at once");
  }
  log_warning("b");
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "binosplat: told at once\nbinosplat: warning: a 1 (3 times)\nbinosplat: warning: b\n"
            "binosplat: warning: b\n");
}

TEST(Progress, AppearsOnlyForLongWork) {
  testing::internal::CaptureStderr();
  {
    Progress progress("reading x.ply", 200);
    progress.update(1);
    std::this_thread::sleep_for(std::chrono::milliseconds(1010));
    EXPECT_EQ(latest_progress(), "");
    progress.update(50);
    progress.update(51);
    EXPECT_EQ(latest_progress(), "reading x.ply 25 %");
    std::this_thread::sleep_for(std::chrono::milliseconds(110));
    progress.update(100);
    EXPECT_EQ(latest_progress(), "reading x.ply 50 %");
  }
  EXPECT_EQ(latest_progress(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "binosplat: reading x.ply 25 %\n");
}

TEST(Progress, EstimatesRemainingTime) {
  testing::internal::CaptureStderr();
  Progress progress("drawing", 100), counted("drawing", 100, "views");
  std::this_thread::sleep_for(std::chrono::milliseconds(5100));
  counted.update(10);
  EXPECT_NE(latest_progress().find(" views a second, 46 s left"), std::string::npos) << latest_progress();
  progress.update(10);
  EXPECT_EQ(latest_progress(), "drawing 10 %, 46 s left");
  testing::internal::GetCapturedStderr();
  EXPECT_EQ(spoken_time(59.2), "1 min 0 s");
  EXPECT_EQ(spoken_time(7500), "2 h 5 min");
}

TEST(Log, QuietModeKeepsWarnings) {
  testing::internal::CaptureStderr();
  set_quiet(true);
  log_info("drawing");
  log_warning("empty");
  set_quiet(false);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "binosplat: warning: empty\n");
}

}  // namespace
}  // namespace binosplat
