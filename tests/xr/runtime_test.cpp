// The test runtime by itself, by a client that does all by the book.

#include <gtest/gtest.h>

#include "xr/xr_script.h"

namespace binosplat::test {
namespace {

Outcome run_client(XrStage& stage, const std::vector<std::string>& words = {}) {
  return run_program(words, {.variables = stage.variables(), .program = BINOSPLAT_XR_CLIENT});
}

using Strings = std::vector<std::string>;

TEST(XrRuntime, FramesRunToTheEnd) {
  XrStage stage;
  stage.script = {{"frames", 4}, {"heads", {xr_pose({0, 1.6, 0}), xr_pose({0, 1.7, 0})}}};
  const Outcome outcome = run_client(stage);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out + outcome.err, "");
  const XrLog log = stage.log();
  EXPECT_EQ(log.faults(), Strings()) << log.text();
  EXPECT_EQ(log.frames().size(), 4u) << log.text();
  EXPECT_TRUE(log.clean()) << log.text();
  EXPECT_EQ(log.states(), (Strings{"IDLE", "READY", "SYNCHRONIZED", "VISIBLE", "FOCUSED", "VISIBLE",
                                   "SYNCHRONIZED", "STOPPING", "IDLE", "EXITING"}));
}

}  // namespace
}  // namespace binosplat::test
