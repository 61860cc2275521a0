// The test runtime by itself, by a client that does all by the book but for the faults that it is told to
// make.

#include <gtest/gtest.h>

#include <chrono>

#include "xr/xr_script.h"

namespace binosplat::test {
namespace {

using Strings = std::vector<std::string>;

Outcome run_client(XrStage& stage, const Strings& words = {}) {
  return run_program(words, {.variables = stage.variables(), .program = BINOSPLAT_XR_CLIENT});
}

/// Of a client that is expected to find nothing wrong.
XrLog good_log(XrStage& stage, const Strings& words = {}) {
  const Outcome outcome = run_client(stage, words);
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out + outcome.err, "");
  XrLog log = stage.log();
  EXPECT_EQ(log.faults(), Strings()) << log.text();
  EXPECT_TRUE(log.clean()) << log.text();
  return log;
}

TEST(XrRuntime, FramesRunToTheEnd) {
  XrStage stage;
  stage.script = {{"frames", 4}, {"heads", {xr_pose({0, 1.6, 0}), xr_pose({0, 1.7, 0})}}};
  const XrLog log = good_log(stage);
  EXPECT_EQ(log.states(), (Strings{"IDLE", "READY", "SYNCHRONIZED", "VISIBLE", "FOCUSED", "VISIBLE",
                                   "SYNCHRONIZED", "STOPPING", "IDLE", "EXITING"}));
  const auto frames = log.frames();
  ASSERT_EQ(frames.size(), 4u) << log.text();
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(frames[k]["time"], 1'000'000'000 + static_cast<std::int64_t>(k) * 11'111'111);
    EXPECT_EQ(frames[k]["head"]["position"][1], k == 0 ? 1.6f : 1.7f) << "the last pose stays";
    EXPECT_EQ(XrLog::view(frames[k], 0)["image"], k % 3);
    EXPECT_NEAR(XrLog::view(frames[k], 1)["pose"]["position"][1].get<double>(), k == 0 ? 0.0 : 0.1, 1e-6);
    EXPECT_EQ(XrLog::view(frames[k], 1)["pose"]["position"][0], 0.0315f);
  }
}

/// What xr/client.cpp paints, or with another upper half.
void expect_painted(const XrLog& log, const Json& frame, std::size_t view, std::array<std::size_t, 2> size,
                    bool depth) {
  const std::string pixels = log.colours(frame, view);
  const std::size_t count = std::size_t{4} * size[0] * size[1];
  ASSERT_EQ(pixels.size(), count);
  const auto expect_row = [&](std::size_t at, int red) {
    EXPECT_EQ(static_cast<unsigned char>(pixels[at]), red) << frame.dump();
    EXPECT_EQ(pixels[at + 1], static_cast<char>(10 * view));
    EXPECT_EQ(pixels[at + 2], static_cast<char>(frame["frame"].get<int>()));
  };
  expect_row(0, 200);
  expect_row(count / 2 - 4, 200);
  expect_row(count / 2, 100);
  expect_row(count - 4, 100);
  if (!depth) return;
  const auto depths = log.depths(frame, view);
  ASSERT_EQ(depths.size(), count / 4);
  EXPECT_NEAR(depths.front(), 0.5 + static_cast<double>(view) / 16, 1e-7);
  EXPECT_NEAR(depths.back(), 0.25 + static_cast<double>(view) / 16, 1e-7);
}

TEST(XrRuntime, PixelsArriveTheRightWayUp) {
  for (const Strings& words : {Strings{"depth"}, Strings{"depth", "depth24"}}) {
    for (const bool immutable : {true, false}) {
      XrStage stage;
      stage.script = {{"frames", 2}, {"immutable", immutable}};
      const XrLog log = good_log(stage, words);
      ASSERT_EQ(log.frames().size(), 2u);
      for (const Json& frame : log.frames()) {
        for (std::size_t view = 0; view < 2; ++view) expect_painted(log, frame, view, {96, 80}, true);
      }
    }
  }
}

TEST(XrRuntime, WrongPicturesAreSeenInPixels) {
  const auto first = [](const std::string& word) {
    XrStage stage;
    stage.script = {{"frames", 1}};
    run_client(stage, {word});
    const XrLog log = stage.log();
    return log.colours(log.frames().at(0), 0);
  };
  const std::string good = first("");
  EXPECT_NE(first("upside_down"), good);
  EXPECT_NE(first("pictures_swapped"), good);
}

TEST(XrRuntime, FourViewsHaveTheirOwnSizes) {
  XrStage stage;
  stage.script["frames"] = 2;
  stage.script["views"]["quad"] = {xr_view(64, 48, {-0.8, 0.7, 0.7, -0.7}, xr_pose({-0.03, 0, 0})),
                                   xr_view(64, 48, {-0.7, 0.8, 0.7, -0.7}, xr_pose({0.03, 0, 0})),
                                   xr_view(40, 36, {-0.2, 0.1, 0.1, -0.2}, xr_pose({-0.03, 0, 0})),
                                   xr_view(40, 36, {-0.1, 0.2, 0.1, -0.2}, xr_pose({0.03, 0, 0}))};
  const XrLog log = good_log(stage, {"quad", "depth"});
  ASSERT_EQ(log.frames().size(), 2u);
  for (const Json& frame : log.frames()) {
    for (std::size_t view = 0; view < 4; ++view) {
      expect_painted(log, frame, view,
                     view < 2 ? std::array<std::size_t, 2>{64, 48} : std::array<std::size_t, 2>{40, 36},
                     true);
    }
    EXPECT_EQ(XrLog::view(frame, 2)["fov"][0], -0.2f);
  }
}

TEST(XrRuntime, FramesThatAreNotShownHaveNoPictures) {
  XrStage stage;
  stage.script = {{"frames", 6}, {"invisible_frames", 2}, {"not_rendered", {3}}, {"pixels", {4}}};
  stage.add_event({{"frame", 5}, {"state", "synchronized"}});
  const XrLog log = good_log(stage);
  std::vector<bool> rendered, kept;
  for (const Json& frame : log.frames()) {
    rendered.push_back(frame["should_render"]);
    kept.push_back(!frame["layers"].empty() && !XrLog::view(frame, 0)["colour"].is_null());
  }
  EXPECT_EQ(rendered, (std::vector<bool>{false, false, true, false, true, false}));
  EXPECT_EQ(kept, (std::vector<bool>{false, false, false, false, true, false}));
  // Shown all the same: no fault, but told apart.
  XrStage stale;
  stale.script = {{"frames", 3}, {"not_rendered", {1}}};
  EXPECT_EQ(good_log(stale, {"always_shows"}).all("stale").size(), 2u);
}

TEST(XrRuntime, SessionsStopAndBeginAgain) {
  XrStage stage;
  stage.script = {{"frames", 5}};
  stage.add_event({{"frame", 2}, {"state", "stopping"}, {"then", "ready"}});
  const XrLog log = good_log(stage);
  EXPECT_EQ(log.all("begin").size(), 2u);
  EXPECT_EQ(log.frames().size(), 5u);
  XrStage second;
  second.script = {{"frames", 3}};
  second.add_event({{"frame", 1}, {"state", "loss_pending"}});
  run_client(second, {"again"});
  EXPECT_EQ(second.log().faults(), Strings());
  EXPECT_EQ(second.log().all("session").size(), 2u);
  EXPECT_EQ(second.log().frames().size(), 3u) << "frames are counted on";
  EXPECT_TRUE(second.log().clean());
  XrStage lost;
  lost.add_event({{"frame", 1}, {"state", "loss_pending"}});
  EXPECT_EQ(run_client(lost).out, "xrEndFrame: XR_SESSION_LOSS_PENDING\n");
  EXPECT_EQ(lost.log().states().back(), "LOSS_PENDING");
  EXPECT_EQ(lost.log().faults(), Strings());
}

TEST(XrRuntime, RecentringMovesLocalAndNotStage) {
  for (const std::string space : {"", "stage", "floor"}) {
    XrStage stage;
    stage.script = {{"frames", 3}, {"heads", {xr_pose({0.5, 1.6, 0})}}};
    stage.add_event({{"frame", 2}, {"recentre", xr_pose({0.5, 1.6, 1.0}, {0, 1, 0, 0})}});
    const XrLog log = good_log(stage, {space});
    const auto at = [&](std::size_t frame) {
      return XrLog::view(log.frames().at(frame), 0)["pose"]["position"].get<std::array<double, 3>>();
    };
    EXPECT_NEAR(at(1)[0], 0.5 - 0.0315, 1e-6);
    EXPECT_NEAR(at(2)[0], space == "stage" ? 0.5 - 0.0315 : 0.0315, 1e-6);
    EXPECT_NEAR(at(1)[1], space.empty() ? 0.0 : 1.6, 1e-6);
    EXPECT_NEAR(at(2)[2], space == "stage" ? 0.0 : 1.0, 1e-6);
  }
}

TEST(XrRuntime, FramesTakeTheirTimeWhereTheyAreTold) {
  XrStage stage;
  stage.script = {{"frames", 4}, {"sleep", true}, {"period", 50'000'000}};
  const auto begin = std::chrono::steady_clock::now();
  good_log(stage);
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(200));
}

TEST(XrRuntime, RecommendedSizesChange) {
  XrStage stage;
  stage.add_event({{"frame", 1}, {"view", {{"index", 1}, {"width", 64}, {"height", 60}}}});
  EXPECT_EQ(run_client(stage, {"sizes"}).out, "1 view 1: 64 x 60\n");
  EXPECT_EQ(stage.log().faults(), Strings());
}

TEST(XrRuntime, ScriptedResultsAreReturned) {
  XrStage stage;
  stage.add_event(
      {{"frame", 1}, {"fail", "xrWaitSwapchainImage"}, {"result", "XR_TIMEOUT_EXPIRED"}, {"times", 2}});
  EXPECT_EQ(run_client(stage).out,
            "xrWaitSwapchainImage: XR_TIMEOUT_EXPIRED\nxrWaitSwapchainImage: XR_TIMEOUT_EXPIRED\n");
  EXPECT_EQ(stage.log().faults(), Strings());
  EXPECT_EQ(stage.log().frames().size(), 3u);
  XrStage lost;
  lost.add_event({{"frame", 1}, {"fail", "xrEndFrame"}, {"result", "XR_ERROR_SESSION_LOST"}});
  EXPECT_EQ(run_client(lost).out, "xrEndFrame: XR_ERROR_SESSION_LOST\nxrWaitFrame: XR_ERROR_SESSION_LOST\n");
  EXPECT_TRUE(lost.log().clean()) << "what is lost can be destroyed";
  XrStage none;
  none.script = {{"system", "XR_ERROR_FORM_FACTOR_UNAVAILABLE"}};
  EXPECT_EQ(run_client(none).out, "xrGetSystem: XR_ERROR_FORM_FACTOR_UNAVAILABLE\n");
  EXPECT_EQ(none.log().faults(), Strings());
}

TEST(XrRuntime, ScriptsThatMeanNothingAreRefused) {
  for (const Json& script : {Json{{"frame", 3}}, Json{{"formats", {"GL_RGB9"}}}, Json{{"frames", "three"}}}) {
    XrStage stage;
    stage.script = script;
    const Outcome outcome = run_client(stage);
    EXPECT_NE(outcome.err.find("xr_test_runtime: "), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find(script.begin().key()), std::string::npos) << outcome.err;
  }
}

TEST(XrRuntime, KhronosValidationAgrees) {
  const auto run = [](XrStage& stage, const std::string& word) {
    return stage.validation(
        run_program({word}, {.variables = stage.validated_variables(), .program = BINOSPLAT_XR_CLIENT}));
  };
  XrStage good, bad;
  EXPECT_EQ(run(good, "depth"), "");
  EXPECT_EQ(good.log().faults(), Strings());
  EXPECT_EQ(good.log().frames().size(), 3u);
  EXPECT_NE(run(bad, "view_layer_type").find("VUID-XrCompositionLayerProjectionView-type-type"),
            std::string::npos);
}

}  // namespace
}  // namespace binosplat::test
